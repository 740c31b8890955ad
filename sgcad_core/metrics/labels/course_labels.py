"""Labels of the whole course of a crash, read from the text by people, and the agreement of two readers.

One JSON object a case, `<case>.json`; docs/metrics.md says what each field means. Reads dictionaries; knows no file.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any, NamedTuple, get_args

from sgcad_core.errors import BadInput
from sgcad_core.kinds import Maneuver
from sgcad_core.metrics.rest_error import COMPASS_DEG
from sgcad_core.records.course import Attitude, Pace, Spin, Where

DEEDS = ("brake", "steer", "steer_left", "steer_right")
LANES = ("left", "right", "middle", "center_turn")
_POINTS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
POINT_DEG: dict[str, float] = {word: 22.5 * i for i, word in enumerate(_POINTS)}
_SPINS: dict[str, Spin] = {"cw": "clockwise", "ccw": "counterclockwise"}
_WHERE: tuple[Where, ...] = get_args(Where)
_REST = ("facing", "where", "side", "attitude", "against", "turned")
_FIELDS = ("maneuver", "lane", "speed_mph", "evasion", "lost_control", "rest")


@dataclass(frozen=True)
class RestLabel:
    """Rest of a vehicle; None where the text does not state it."""

    facing: str | None = None
    """A point of the 16-wind compass."""
    where: Where | None = None
    side: str | None = None
    attitude: Attitude | None = None
    against: str | None = None
    turned: str | None = None
    """cw or ccw: rotation after its first contact."""

    @property
    def spin(self) -> Spin | None:
        """The turning in words."""
        return _SPINS.get(self.turned or "")


@dataclass(frozen=True)
class VehicleLabel:
    """Statements of the text on one vehicle; `evasion` is () where it states that nothing was done, None where it is
    silent."""

    maneuver: Maneuver | None = None
    lane: str | int | None = None
    speed_mph: float | None = None
    pace: Pace | None = None
    evasion: tuple[str, ...] | None = None
    lost_control: bool | None = None
    rest: RestLabel = field(default_factory=RestLabel)


@dataclass(frozen=True)
class CourseLabel:
    """One case: its vehicles by id, and all contacts in order, each as (actor, other): an id or a thing's name."""

    case: str
    vehicles: Mapping[str, VehicleLabel]
    impacts: tuple[tuple[str, str], ...]


def course_label(raw: Mapping[str, Any], source: str) -> CourseLabel:
    """A label of its dictionary. Raises BadInput naming field, value and what is allowed."""
    _known(raw, ("case", "vehicles", "impacts"), source)
    vehicles = {str(v): _vehicle(dict(of), f"{source}, vehicle {v}") for v, of in dict(raw.get("vehicles", {})).items()}
    impacts = tuple(_impact(pair, source) for pair in raw.get("impacts", ()))
    return CourseLabel(str(raw.get("case", source)), vehicles, impacts)


def _vehicle(raw: Mapping[str, Any], source: str) -> VehicleLabel:
    _known(raw, _FIELDS, source)
    _one_of(raw.get("maneuver"), get_args(Maneuver), f"{source}, maneuver")
    lane = raw.get("lane")
    if not isinstance(lane, int):
        _one_of(lane, LANES, f"{source}, lane")
    evasion = raw.get("evasion")
    for deed in evasion or ():
        _one_of(deed, DEEDS, f"{source}, evasion")
    rest = dict(raw.get("rest", {}))
    _known(rest, _REST, f"{source}, rest")
    allowed = {"facing": _POINTS, "where": _WHERE, "side": (*COMPASS_DEG, "left", "right"), "turned": tuple(_SPINS)}
    for name, words in {**allowed, "attitude": get_args(Attitude)}.items():
        _one_of(rest.get(name), words, f"{source}, rest.{name}")
    told = None if evasion is None else tuple(evasion)
    return VehicleLabel(**{**raw, "evasion": told, "rest": RestLabel(**rest)})


def _impact(pair: Any, source: str) -> tuple[str, str]:
    if not isinstance(pair, list | tuple) or len(pair) != 2 or not all(isinstance(one, str) for one in pair):
        raise BadInput(f"{source}, impacts: {pair!r} is not a pair of names; write [actor, other]")
    return pair[0], pair[1]


def _known(raw: Mapping[str, Any], fields: Sequence[str], source: str) -> None:
    odd = sorted(set(raw) - set(fields))
    if odd:
        raise BadInput(f"{source}: unknown field {', '.join(odd)}; known are {', '.join(fields)}")


def _one_of(value: Any, words: Sequence[str], where: str) -> None:
    if value is not None and value not in words:
        raise BadInput(f"{where} is {value!r}; allowed are {', '.join(words)}")


# ------------------------------------------------------------------ two readers
class Agreement(NamedTuple):
    """Of one field: places that either reader filled, the share on which both agree, and Cohen's kappa."""

    field: str
    places: int
    agreed: float
    kappa: float


def agreements(first: Mapping[str, CourseLabel], second: Mapping[str, CourseLabel]) -> list[Agreement]:
    """Agreement of two readings of the same cases, field by field (vehicles that both name)."""
    pairs = [(a, second[case].vehicles[v]) for case, label in first.items() if case in second
             for v, a in label.vehicles.items() if v in second[case].vehicles]  # fmt: skip
    fields = [*_FIELDS[:-1], *(f"rest.{name}" for name in _REST)]
    found = [_agreement(name, [(attrgetter(name)(a), attrgetter(name)(b)) for a, b in pairs]) for name in fields]
    impacts = [(label.impacts[1:], second[case].impacts[1:]) for case, label in first.items() if case in second]
    return [*found, _agreement("impacts", impacts)]


def _agreement(name: str, pairs: Sequence[tuple[Hashable, Hashable]]) -> Agreement:
    """Kappa over all places, silent ones too (J. Cohen, A coefficient of agreement for nominal scales, 1960)."""
    filled = [(a, b) for a, b in pairs if a not in (None, ()) or b not in (None, ())]
    same = sum(a == b for a, b in pairs) / max(len(pairs), 1)
    words = {word for pair in pairs for word in pair}
    chance = sum(
        sum(a == w for a, _ in pairs) * sum(b == w for _, b in pairs) for w in words
    ) / max(len(pairs), 1) ** 2  # fmt: skip
    kappa = 1.0 if chance >= 1.0 else (same - chance) / (1.0 - chance)
    return Agreement(name, len(filled), sum(a == b for a, b in filled) / max(len(filled), 1), kappa)


def agreed(first: CourseLabel, second: CourseLabel) -> CourseLabel:
    """The common statements of both readers; impacts only where both have the same ones in the same order."""
    vehicles = {v: _both(a, second.vehicles[v]) for v, a in first.vehicles.items() if v in second.vehicles}
    impacts = first.impacts if first.impacts == second.impacts else first.impacts[:1]
    return CourseLabel(first.case, vehicles, impacts)


def _both(a: VehicleLabel, b: VehicleLabel) -> VehicleLabel:
    rest = replace(a.rest, **dict.fromkeys(_differing(a.rest, b.rest, _REST)))
    return replace(a, rest=rest, **dict.fromkeys(_differing(a, b, _FIELDS[:-1])))


def _differing(a: object, b: object, names: Sequence[str]) -> Iterator[str]:
    return (name for name in names if getattr(a, name) != getattr(b, name))
