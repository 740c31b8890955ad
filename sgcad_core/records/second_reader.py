"""A second reader's values for a crash and their weights against the rules. Plain records: knows no reader."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pydantic import Field

from sgcad_core.record_base import Record
from sgcad_core.records.specs import BehaviorSpec, RoadLayout

Value = bool | str
MOST_NATS = 6.0
"""More grounding than that says no more: the report makes the value 400 times likelier."""
DRAWN = "whole_drawn"
"""Weights of the same model for reports with a drawing, which shows it much that their text does not tell. They suppose
that the model sees drawings, as the embedded one does."""
HEARD = "whole_learned"
"""Weights of the same model for reports without a drawing of which the learned reader of numbered reports says
something."""
LEARNED = "learned"
"""In a config's `second_opinion`: the reader that learned where the rules err
(`sgcad_core.reading.second_reader.learned_reader`)."""
WHOLE = "whole"
"""The config's model, which is asked for road and behavior of every report that numbers its vehicles
(`sgcad_core.reading.second_reader.fuse_whole`)."""
WEIGHTS = Path(__file__).parents[1] / "reading" / "second_reader" / "learned.npz"
"""What that reader learned."""
NUMBERED_WEIGHTS = WEIGHTS.with_name("numbered.npz")
"""What the reader of numbered reports learned (`sgcad_core.reading.second_reader.numbered.numbered_reader`)."""
ENCODER_WEIGHTS = WEIGHTS.with_name("encoder.npz")
"""What the encoder learned that is heard beside it (`sgcad_core.reading.second_reader.encoder_reader`)."""


class Weights(Record):
    """How one field is decided where both readers differ (`sgcad_core.reading.second_reader.combiner`), and `agree`:
    how often both are right where they do not (None: as sure as the second reader is)."""

    differ: float = 0.0
    slope: float = 1.0
    told: float = 0.0
    nats: float = 0.0
    """Per nat by which the report makes the value likelier than it is without it, up to `MOST_NATS`."""
    tells: float = 0.0
    """Per unit of the log-odds that the evidence tells the value, by the model's own head."""
    learned: float = 0.0
    """Per unit of the log-odds of the value against the rules' own, by the learned reader."""
    agree: float | None = Field(0.9, ge=0, le=1)


class Heard(Record):
    """The model's value of a field and its probability."""

    value: Value
    p: float = Field(ge=0, le=1)


class Answered(Record):
    """A model's answers to a whole report."""

    layout: RoadLayout
    behavior: BehaviorSpec
    p: Mapping[str, float] = {}
    """Probability of each value by its path ("road.legs[0].lanes_in", "crash.actors[1].maneuver"); no entry: 1, since
    nothing was chosen. Empty: nothing is known."""
    nats: Mapping[str, float] = {}
    """Grounding of each value by the same path: log p(y|c,x) - log p(y|x). Empty: not measured."""
    told: Mapping[str, float] = {}
    """Probability that the evidence tells each value, by the same path, of a model that has heads for it."""


class Guess(Record):
    """What the learned reader of numbered reports says of one question: another answer than the rules' (None: theirs
    stands), the probability of what stands, its share for every answer, and the number of the sentence that speaks for
    the other one."""

    value: str | None = None
    p: float = Field(ge=0, le=1)
    shares: Mapping[str, float] = {}
    sentence: int | None = None


class Unsure(Record):
    """An answer of the final reading that the learned reader of numbered reports holds to be right less often than
    `LEAST_SURE` of `sgcad_core.reading.second_reader.numbered.unsure_answers`; `question`: as that reader asks it
    ("lanes.V1")."""

    question: str
    p: float = Field(ge=0, le=1)


class Opinion(Record):
    """The second reader's values and their weights against the rules. Fields without weights are the rules'."""

    heard: Mapping[str, Heard] = {}
    weights: Mapping[str, Weights] = {}
    answered: Answered | None = None
    """What it answers to the whole report; its weights then go by kinds of
    `sgcad_core.reading.second_reader.field_claims`."""
    guesses: Mapping[str, Guess] = {}
    """What the learned reader says of a numbered report, by the fields of its questions."""
    takes: float = Field(0.5, ge=0, le=1)
    """Probability from which on another value than the rules' is taken."""
    taken: bool = True
    """False: none of its values is taken; its guesses still say how sure the rules' own are."""
