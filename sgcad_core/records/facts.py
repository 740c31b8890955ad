"""One thing that is taken to be so of a crash, and why. Knows no report, no reader and no file."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from sgcad_core.record_base import Record
from sgcad_core.record_base import Value as Value

Basis = Literal["text", "diagram", "model", "default", "person"]
Status = Literal["stated", "inferred", "default"]


class Fact(Record):
    """One thing that is taken to be so, and why.

    `field` is a dotted name ("vehicles.V1.heading", "roads.main.lanes_forward"); a name with a unit has it at its end
    (_mph, _m), compass words are N to NW. `basis`: where it is from; `status`: whether the basis says it, it follows
    from what is said, or nothing is said. `rule`: the wording, or the step of reading or writing. [start, end): the
    sentence's characters in the narrative as it was written (`CrashReport.places`); None where no sentence tells it.
    `confidence`: of [0, 1], see `sgcad_core.reading.provenance.crash_provenance.Confidence`. `nats`: a model's
    grounding of it.
    """

    field: str
    value: Value
    basis: Basis
    status: Status
    rule: str
    start: int | None = None
    end: int | None = None
    confidence: float = Field(ge=0, le=1)
    nats: float | None = None
