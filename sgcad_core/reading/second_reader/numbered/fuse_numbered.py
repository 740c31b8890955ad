"""A reading of a numbered report with what the learned reader knows better, question by question.

Each answer that is taken changes the reading as a whole: a vehicle that does not turn has no way out of a turn, one
that does has a junction. A change that would not show in the layout is not taken. Every value is a fact of the basis
"model" with the sentence that speaks for it. Knows no weights.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, cast

from sgcad_core.kinds import FOUR_LEG
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.junctions.junction import JunctionFacts
from sgcad_core.reading.junctions.junction_stem import crossing
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.provenance.road_provenance import road_names
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_facts import RoadFact
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.fuse_gist import TURNS
from sgcad_core.reading.second_reader.numbered.numbered_answers import body_way, first_contact, lanes_of, same
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.facts import Fact
from sgcad_core.records.facts import Value as FactValue
from sgcad_core.records.specs import Area, Compass, Maneuver

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading
    from sgcad_core.reading.roads.road_facts import RoadFacts
    from sgcad_core.records.second_reader import Guess

RULE = "learned from coded reports"
"""The rule of its facts."""
_OF_TURN = ("exit_heading", "meant_maneuver", "from_stop")
"""Facts of a maneuver that go with it."""
Values = Mapping[str, FactValue]


class Changed(NamedTuple):
    """A reading's parts after a change: the new facts by field, and the fields that are gone."""

    crash: CrashFacts
    roads: RoadFacts
    facts: Values
    gone: tuple[str, ...] = ()


def fused_with_guesses(reading: Reading, guesses: Mapping[str, Guess]) -> Reading:
    """The reading with the answers that are taken; as it is where there are none, and for reports without a crash."""
    if reading.crash.unnumbered or reading.crash.gap or reading.crash.near_crash:
        return reading
    guesses = {field: guess for field, guess in guesses.items() if not _outdone(reading.crash, field, guesses)}
    for kind, change in _CHANGES.items():
        for field, guess in guesses.items():
            if guess.value is None or kind_of(field) != kind:
                continue
            changed = change(reading.crash, reading.roads, field.partition(".")[2], guess.value)
            reading = reading if changed is None else _told(reading, changed, guess)
    return reading


def _outdone(crash: CrashFacts, field: str, guesses: Mapping[str, Guess]) -> bool:
    """Whether lanes of a road are surer otherwise by those of another vehicle on it."""
    v, mine = crash.vehicle(field.partition(".")[2]), guesses[field]
    if kind_of(field) != "lanes" or v is None or v.heading is None:
        return False
    here = [w for w in crash.vehicles if w is not v and w.heading and axis_of(w.heading) == axis_of(v.heading)]
    others = [guesses[name] for w in here if (name := f"lanes.{w.id}") in guesses]
    return any(other.value != mine.value and other.p >= mine.p for other in others)


def _told(reading: Reading, changed: Changed, guess: Guess) -> Reading:
    """The reading with a change, its facts in the place of those of the same fields."""
    gone = {*changed.facts, *changed.gone}
    kept = tuple(fact for fact in reading.facts if fact.field not in gone)
    place = {}
    if guess.sentence is not None and guess.sentence < len(reading.sentences):
        said = reading.sentences[guess.sentence]
        place = {"start": said.start, "end": said.end}
    facts = [
        Fact(
            field=field, value=value, basis="model", status="inferred", rule=RULE, confidence=round(guess.p, 3), **place
        )
        for field, value in changed.facts.items()
    ]
    roads = replace(changed.roads, crash=changed.crash)
    return replace(reading, crash=changed.crash, roads=roads, facts=(*kept, *facts))


# ------------------------------------------------------------------ vehicles
def _maneuver(crash: CrashFacts, roads: RoadFacts, of: str, value: str) -> Changed | None:
    v = crash.vehicle(of)
    if v is None or (value == "overtaking" and len(crash.vehicles) == 1):  # a lone vehicle passes nothing
        return None
    first = first_contact(crash)
    if value in TURNS and first is not None and of not in (first.striker, first.struck):  # nothing tells it turns
        return None
    if value == "lane_change_left" and _comes_against(crash, v):  # to the left it is over the middle of the road
        value = "crossing_centerline"
    new = moved(v, cast("Maneuver", value))
    if value in TURNS and roads.junction.kind == "none":
        roads = replace(roads, junction=replace(roads.junction, kind=FOUR_LEG))
    kept = new.exit_heading is not None
    gone = tuple(f"vehicles.{of}.{name}" for name in _OF_TURN if not (kept and name == "exit_heading"))
    return Changed(_with(crash, new), roads, {f"vehicles.{of}.maneuver": value}, gone)


def _comes_against(crash: CrashFacts, v: VehicleFacts) -> bool:
    """Whether a vehicle first touches one that is told to come the other way."""
    other = crash.first_met(v.id)
    if other is None or v.heading is None or not (other.heading_stated and v.heading_stated):
        return False
    return other.heading == turned(v.heading, 180)


def moved(v: VehicleFacts, maneuver: Maneuver) -> VehicleFacts:
    """A vehicle with another maneuver, without a way out that is not of it."""
    quarter = QUARTER_DEG.get(maneuver)
    fits = quarter is not None and v.heading is not None and v.exit_heading == turned(v.heading, quarter)
    way = {} if fits else {"exit_heading": None, "meant": None}
    return replace(v, maneuver=maneuver, maneuver_stated=True, from_stop=False, **way)  # type: ignore[arg-type]


def _turned(crash: CrashFacts, roads: RoadFacts, of: str, value: str) -> Changed | None:
    """The untold one of the first two headings, so that the second body is turned so far against the first one."""
    one, two = crash.vehicle("V1"), crash.vehicle(of)
    if one is None or two is None or (one.heading_stated and two.heading_stated):
        return None
    way, other, by = (one, two, int(value)) if not two.heading_stated else (two, one, -int(value))
    if (body := body_way(way)) is None:
        return None
    backs = other.maneuver == "backing" and not other.faces
    new = replace(other, heading=turned(turned(body, by), 180 if backs else 0), exit_heading=None)
    if int(value) % 180 and roads.junction.kind == "none":
        roads = replace(roads, junction=replace(roads.junction, kind=FOUR_LEG))
    at = f"vehicles.{other.id}"
    return Changed(_with(crash, new), roads, {f"{at}.heading": new.heading}, (f"{at}.exit_heading",))


def _with(crash: CrashFacts, new: VehicleFacts) -> CrashFacts:
    return replace(crash, vehicles=tuple(new if v.id == new.id else v for v in crash.vehicles))


# ------------------------------------------------------------------ contact
def _area(crash: CrashFacts, roads: RoadFacts, of: str, value: str) -> Changed | None:
    first, side = first_contact(crash), cast("Area", value)
    if first is None or of not in (first.striker, first.struck):
        return None
    role = "striker" if of == first.striker else "struck"
    new = replace(first, **{f"{role}_area": side, f"{role}_may": (side,)})  # type: ignore[arg-type]
    return Changed(replace(crash, contacts=(new, *crash.contacts[1:])), roads, {f"contacts.0.{role}_area": side})


# ------------------------------------------------------------------ roads
def _junction(crash: CrashFacts, roads: RoadFacts, _: str, value: str) -> Changed | None:
    if value == "yes":
        made = replace(roads.junction, kind=FOUR_LEG)
    elif (
        roads.junction.control != "none"
        or crossing(crash.vehicles)
        or any(v.maneuver in TURNS or v.origin or v.target for v in crash.vehicles)
    ):
        return None
    else:
        made = JunctionFacts(unsupported=roads.junction.unsupported)
    new = replace(roads, junction=made)
    layout = layout_of_facts(new)
    if (len(layout.legs) > 2 or bool(layout.accesses)) != (value == "yes"):
        return None
    gone = tuple(f"junction.{name}" for name in ("stem", "control", "stopped")) if value == "no" else ()
    return Changed(crash, new, {"junction.kind": made.kind}, gone)


def _lanes(crash: CrashFacts, roads: RoadFacts, of: str, value: str) -> Changed | None:
    v = crash.vehicle(of)
    if v is None or v.heading is None or not roads.streets:
        return None
    axis, count, both = axis_of(v.heading), int(value.lstrip("ownbth")), value.startswith("both")
    road = next((one for one in roads.streets if one.axis == axis), None)
    if road is None or (not both and road.lanes.toward.get(v.heading) not in (None, count)):
        return None  # the text counts the lanes of that direction
    lanes = _counted(road.lanes, v.heading, count, both)
    new = _with_lanes(roads, road, lanes)
    if not same(value, lanes_of(v, layout_of_facts(new))):
        return None
    at = f"roads.{dict(zip(map(id, roads.roads), road_names(roads), strict=True))[id(road)]}"
    gone = (f"{at}.lanes_total", f"{at}.lanes_each_way")
    return Changed(crash, new, {f"{at}.lanes_{'total' if both else 'each_way'}": count}, gone)


def _counted(lanes: LaneFacts, toward: Compass, count: int, both: bool) -> LaneFacts:
    """Lanes with another number, of both directions or of one."""
    if both:
        whole = replace(lanes, one_way=None, one_way_toward=None, divided=None, median=None, one_lane=False, own=None)
        return replace(whole, total=count, each_way=None, toward={})
    total = count if lanes.one_way else None
    return replace(lanes, total=total, each_way=count, toward={toward: count}, one_lane=False, own=None)


def _with_lanes(roads: RoadFacts, road: RoadFact, lanes: LaneFacts) -> RoadFacts:
    return replace(roads, roads=tuple(replace(one, lanes=lanes) if one is road else one for one in roads.roads))


_CHANGES: Mapping[str, Callable[[CrashFacts, RoadFacts, str, str], Changed | None]] = {
    "turned": _turned, "maneuver": _maneuver, "junction": _junction, "lanes": _lanes, "area": _area,
}  # fmt: skip
"""In this order: ways before maneuvers, and both before the roads that carry them."""
