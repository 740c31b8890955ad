"""What the desk's pages go by in a result.json, of any version: types of what is there, all but the status optional.

Another program, or a hand, may have written the file. Knows no file and no page.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

MOST = 100_000
"""Rows of a list."""
Text = Annotated[str, Field(max_length=1_000_000)]
Real = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Number = Annotated[int, Field(strict=True, ge=-(10**12), le=10**12)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="ignore")


class _Fact(_Part):
    field: Text
    value: Any
    basis: Text
    status: Text
    confidence: Real
    start: Number | None = None


class _Sentence(_Part):
    start: Number
    end: Number


class _Item(_Part):
    kind: Text
    text: Text
    field: Text | None = None
    start: Number | None = None


class _Account(_Part):
    verdict: Text | None = None
    told: Number
    has: Number
    lacking: Number
    assumed: Number
    items: Annotated[list[_Item], Field(max_length=MOST)] | None = None
    sentence: Text | None = None


class _Note(_Part):
    kind: Text
    text: Text
    field: Text | None = None
    subject: Text | None = None
    start: Number | None = None


class _Pair(_Part):
    striker: Text
    struck: Text
    striker_area: Text
    struck_area: Text


class _Seen(_Part):
    actor: Text
    other: Text
    actor_area: Text
    other_area: Text
    t_s: Real


class _Collision(_Part):
    declared: _Pair | None = None
    observed: _Seen | None = None
    realised: bool | None = None


class _Conflict(_Part):
    conflict: _Pair


class _Near(_Part):
    declared: _Conflict
    realised: bool | None


class _Actor(_Part):
    id: Text
    maneuver: Text | None = None
    type: Text = ""
    length_m: Real = 4.0
    width_m: Real = 2.0


class _Network(_Part):
    intersections: Number | None


class _Disagreement(_Part):
    field: Text


class _Result(_Part):
    status: Text
    reason: Text | None = None
    case: Text | None = None
    config: Text | None = None
    network: _Network | None = None
    actors: Annotated[list[_Actor], Field(max_length=MOST)] | None = None
    collision: _Collision | None = None
    near_crash: _Near | None = None
    sentences: Annotated[list[_Sentence], Field(max_length=MOST)] | None = None
    facts: Annotated[list[_Fact], Field(max_length=MOST)] | None = None
    seconds: dict[str, Real] | None = None
    account: _Account | None = None
    disagreements: Annotated[list[_Disagreement], Field(max_length=MOST)] | None = None
    notes: Annotated[list[_Note | Text], Field(max_length=MOST)] | None = None


def shape_fault(result: object) -> str:
    """The first thing that is odd in a result, with its place; "" for nothing."""
    if not isinstance(result, dict):
        return f"a {type(result).__name__} instead of an object"
    try:
        _Result.model_validate(result)
    except ValidationError as told:
        faults = told.errors(include_url=False, include_context=False)
        place = ".".join(str(part)[:60] for part in faults[0]["loc"])
        rest = f", and {len(faults) - 1} more" if len(faults) > 1 else ""
        return f"{place}: {faults[0]['msg'].lower()}{rest}"
    return ""
