"""How likely a model's value is right that the rules do not share, and from when on it is taken. All of it.

    sigmoid(differ + slope * logit(p) + told * [the text tells the rules' value] + nats * n + tells * logit(t)
            + learned * l)

p is the model's probability of its value, n the value's grounding, t how likely the evidence tells it by the model's
head, and l how much likelier the learned reader holds it than the rules' value (log odds). The logistic form is Platt's
(1999), "Probabilistic outputs for support vector machines". The figures are fitted on reports whose codes are known and
which are never scored, with bounded signs (`research.training.weight_fit.SIGNS`): a value that is surer, better
grounded, more likely told or more likely by the learned reader is no less likely right, one against what the text
tells no more. What no text tells weighs nothing: against a default `told` is 0. Knows no field and no reader.
"""

from __future__ import annotations

import math

from sgcad_core.records.second_reader import MOST_NATS, Weights

FILLS = 0.6
"""From which probability on a value stands where the rules have none; of answers to the whole report also where they
have one, since the rules name the sentence of each value."""
AGAINST_TOLD = 0.7
"""From which probability on a value of an answer to the whole report stands against one that the text tells."""
FIGURES = ("differ", "slope", "told", "nats", "tells", "learned")
"""Names of the figures, in the order of `terms`."""
_EDGE = 1e-6


def terms(p: float, told: float, nats: float = 0.0, tells: float = 0.5, *, learned: float = 0.0) -> tuple[float, ...]:
    """What the figures multiply, in the order differ, slope, told, nats, tells, learned."""
    grounded = min(max(nats, 0.0), MOST_NATS)
    return 1.0, _logit(p), float(told), grounded, _bounded(_logit(tells)), _bounded(learned)


def _bounded(x: float) -> float:
    return min(max(x, -MOST_NATS), MOST_NATS)


def _logit(p: float) -> float:
    p = min(max(p, _EDGE), 1 - _EDGE)
    return math.log(p / (1 - p))


def model_right(
    weights: Weights, p: float, told: float, nats: float = 0.0, tells: float = 0.5, *, learned: float = 0.0
) -> float:
    """Probability that a model's value is right that the rules do not share; `told`: whether the text tells the rules'
    value outright; `nats`: the value's grounding; `tells`: how likely the evidence tells it, by the model's head;
    `learned`: how much likelier the learned reader holds it than theirs."""
    figures = (getattr(weights, name) for name in FIGURES)
    speaks = terms(p, told, nats, tells, learned=learned)
    return 1 / (1 + math.exp(-sum(a * b for a, b in zip(figures, speaks, strict=True))))


def needed(takes: float, told: float | None) -> float:
    """The probability that a model's value needs; `told`: whether a text tells the rules' value, None without one."""
    return FILLS if told is None else max(takes, AGAINST_TOLD) if told >= 1.0 else takes
