"""What a vehicle did beside its maneuver, as a writer or a person says it: stops, evasion, loss of control, rest.

Part of an actor's spec. A field that is null is not said: there the reading of the text stands (`course_with`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Annotated, Any

from pydantic import Field

from sgcad_core.records.answer_schema import Spec
from sgcad_core.records.course import Attitude, Courses, CourseTold, Hand, RestTold, Spin, Steering, Where
from sgcad_core.records.words import EvasiveManeuver, LaneNumber, RoadSide, SignalState

REST = "rest"


class Rest(Spec):
    """Where a vehicle came to rest, and how; null: not told."""

    where: Where | None = None
    side: RoadSide | None = Field(
        None, description="of the road or the intersection: by compass, or as seen in its direction of travel"
    )
    facing_deg: Annotated[float, Field(ge=0, le=360)] | None = Field(None, description="clockwise from north, E = 90")
    attitude: Attitude | None = Field(None, description="the part it rests on")
    distance_m: Annotated[float, Field(ge=0, le=500)] | None = Field(None, description="from its first contact")
    lane: LaneNumber | None = Field(None, description="1 = at the right curb")


class Acts(Spec):
    """What a vehicle did beside its maneuver; null: not told."""

    from_rest: bool | None = Field(None, description="stood, then moved on into its first contact")
    signal: SignalState | None = Field(None, description="of the traffic signal as it came to the crash")
    evasion: EvasiveManeuver | None = Field(
        None, description="before its first contact; none: told that it did nothing"
    )
    lost_control: bool | None = None
    departs: RoadSide | None = Field(None, description="side by which it left the road before its first contact")
    spin: Spin | None = Field(None, description="after its first contact")
    spin_deg: Annotated[float, Field(ge=0, le=1440)] | None = None
    rolls: bool | None = Field(None, description="rolled over")
    roll_quarters: Annotated[int, Field(ge=1, le=24)] | None = None
    rolls_to: Hand | None = Field(None, description="the side that led as it rolled over")
    rest: Rest | None = None


_SAME = tuple(field.name for field in fields(CourseTold) if field.name in Acts.model_fields and field.name != REST)
"""Fields that a course has by the same name."""
ACT_FIELDS = (
    *(name for name in Acts.model_fields if name != REST), *(f"{REST}.{name}" for name in Rest.model_fields),
)  # fmt: skip
"""Names of the acts as facts have them; those of the rest have its name before them."""


def course_with(course: CourseTold, acts: Acts | None) -> CourseTold:
    """The course that was read, with what a writer says instead."""
    if acts is None:
        return course
    update: dict[str, Any] = {name: value for name in _SAME if (value := getattr(acts, name)) is not None}
    if acts.evasion is not None:
        update |= {"brakes": "braking" in acts.evasion, "steers": steering_of(acts.evasion)}
        update |= {"no_evasion": acts.evasion == "none"}
    if acts.departs not in (None, course.departs):
        update |= {"moves": ()}
    return replace(course, rest=_rest_with(course.rest, acts.rest), **update)


def acts_of(course: CourseTold, signal: SignalState | None = None) -> Acts | None:
    """What a course and a signal tell in these words; None: nothing. Moves in turn, and lanes that are told by a word,
    stay with the course."""
    said: dict[str, Any] = {name: value for name in _SAME if (value := getattr(course, name)) and value != "either"}
    rest = {name: value for name in Rest.model_fields if (value := getattr(course.rest, name)) is not None}
    lane = rest.pop("lane", None)
    rest |= {"lane": lane} if isinstance(lane, int) and lane > 0 else {}
    said |= {"rest": rest} if rest else {}
    said |= {"signal": signal} if signal else {}
    said |= {"evasion": evasion} if (evasion := _evasion_of(course)) else {}
    return Acts.model_validate(said) if said else None


def _evasion_of(course: CourseTold) -> str | None:
    side = f"_{course.steers}" if course.steers in ("left", "right") else ""
    deeds = [*(["braking"] if course.brakes else []), *([f"steering{side}"] if course.steers else [])]
    return "_and_".join(deeds) or ("none" if course.no_evasion else None)


def courses_with(courses: Courses, said: Mapping[str, Acts | None]) -> Courses:
    """The courses of all vehicles, with the acts that are said of some."""
    return {**courses, **{who: course_with(courses.get(who, CourseTold()), acts) for who, acts in said.items() if acts}}


def _rest_with(read: RestTold, said: Rest | None) -> RestTold:
    if said is None:
        return read
    update: dict[str, Any] = {name: value for name in Rest.model_fields if (value := getattr(said, name)) is not None}
    if "where" in update and "side" not in update:
        update["side"] = read.side if read.where in (None, update["where"]) else None
    if update.get("lane", read.lane) != read.lane:
        update["lane_way"] = None
    return replace(read, **update)


def steering_of(evasion: EvasiveManeuver) -> Steering | None:
    """The side to which an evasive maneuver steers; either: it is left open; None: it does not."""
    if "steering" not in evasion:
        return None
    return "left" if evasion.endswith("left") else "right" if evasion.endswith("right") else "either"


def act_of(acts: Acts | None, name: str) -> Any:
    """The value of one of `ACT_FIELDS`; None where it is not said."""
    group, _, last = name.rpartition(".")
    part = acts.rest if acts and group else acts
    return getattr(part, last, None)


def with_said(acts: Acts | None, given: Mapping[str, Any]) -> Acts | None:
    """The acts with given values by their names in `ACT_FIELDS`. Raises pydantic.ValidationError."""
    if not given:
        return acts
    said = acts.model_dump() if acts else {}
    rest = said.get(REST) or {}
    for name, value in given.items():
        group, _, last = name.rpartition(".")
        (rest if group else said)[last] = value
    return Acts.model_validate(said | {REST: rest if any(v is not None for v in rest.values()) else None})
