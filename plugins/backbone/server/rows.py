"""Log-probabilities of a server's top k as rows of logits, and whether a decoder's choice is certain in spite of k.

Log-probabilities differ from logits by one constant a row, so decoders work on them unchanged. Knows tensors and
decoders; no server.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

from plugins.backbone.engine.records import Policy
from plugins.backbone.server.protocol import LEAST, Top

NEVER = float("-inf")


def even(tops: Sequence[Top], vocabulary: int) -> Tensor:
    """The most even distribution that agrees with what is known: (places, vocabulary) in nats.

    What the server did not tell has an even share of the mass that is left, at most the k-th value.
    """
    return torch.stack([_filled(top, vocabulary, _share(top, vocabulary)) for top in tops])


def highest(tops: Sequence[Top], vocabulary: int) -> Tensor:
    """Unknown tokens as likely as any of them alone may be: the k-th value, or all of the mass that is left."""
    return torch.stack([_filled(top, vocabulary, _ceiling(top)) for top in tops])


def lowest(tops: Sequence[Top], vocabulary: int) -> Tensor:
    """Unknown tokens as unlikely as a value can be told."""
    return torch.stack([_filled(top, vocabulary, LEAST) for top in tops])


def rivals(
    policy: Policy, with_context: Top, without_context: Top | None, may: Tensor | None, vocabulary: int
) -> list[int]:
    """Tokens whose unknown values could change a greedy choice at one place; empty if it is certain.

    The best token is taken at its worst, every other one at its best: a token's score must grow with log p(y|c,x), fall
    with log p(y|x) and not depend on other tokens except through the largest of a row, as in cad, vcd and plausible.
    For adacad, whose alpha depends on the whole rows, it is an estimate. `may`: (vocabulary,), what the grammar allows.
    """
    first, second = [with_context], [] if without_context is None else [without_context]
    worst_prior = highest(second, vocabulary) if second else None
    best_prior = lowest(second, vocabulary) if second else None
    least = chosen_from(policy, lowest(first, vocabulary), worst_prior, may)
    best = chosen_from(policy, highest(first, vocabulary), best_prior, may)
    winner = int(least.argmax())
    above = best > least[winner]
    above[winner] = False
    found = [int(token) for token in above.nonzero()[:, 0]]
    return [*found, winner] if found else []


def chosen_from(policy: Policy, with_context: Tensor, without_context: Tensor | None, may: Tensor | None) -> Tensor:
    """Scores of one place, (vocabulary,), from rows (1, vocabulary): the decoder's behind the grammar.

    Where decoder and grammar leave no token they are the row with context behind the grammar, as in the engine.
    """
    for scores in (policy.scores(with_context, without_context)[0], with_context[0]):
        allowed: Tensor = scores if may is None else scores.masked_fill(~may, NEVER)
        if bool((allowed > NEVER).any()):
            break
    return allowed


def unknown(tokens: Sequence[int], top: Top | None) -> list[int]:
    """Those of the tokens that the server has not told at a place."""
    return [token for token in tokens if top is not None and token not in top.known]


def allowed_tokens(may: Tensor | None, vocabulary: int) -> list[int]:
    """Tokens that the grammar allows at one place."""
    return list(range(vocabulary)) if may is None else [int(token) for token in may.nonzero()[:, 0]]


def _filled(top: Top, vocabulary: int, value: float) -> Tensor:
    row = torch.full((vocabulary,), value)
    inside = {token: logp for token, logp in top.known.items() if token < vocabulary}
    row[list(inside)] = torch.tensor(list(inside.values()))
    return row


def _left(top: Top) -> float:
    """The mass of all tokens that are not known."""
    return max(1.0 - math.fsum(math.exp(logp) for logp in top.known.values()), 0.0)


def _ceiling(top: Top) -> float:
    left = _left(top)
    return LEAST if left <= 0.0 else max(min(top.bound, math.log(left)), LEAST)


def _share(top: Top, vocabulary: int) -> float:
    left, count = _left(top), max(1, vocabulary - len(top.known))
    return LEAST if left <= 0.0 else max(min(top.bound, math.log(left / count)), LEAST)
