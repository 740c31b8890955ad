"""Actors added to a behavior after the first contact: objects and people beside the road, and vehicles in a gore.

Ids are those of the crash's others where the same object is among them. Knows facts, actors and roads; no text.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice

from sgcad_core.kinds import RAMP, actor_kind
from sgcad_core.reading.actors.people_objects import Lies, OtherFacts, kind_of_word
from sgcad_core.reading.contacts.contact_records import leading_end
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.layout.road_ways import Way, exits, turn_of, ways_of
from sgcad_core.records.course import ImpactTold
from sgcad_core.records.specs import Actor, ActorKind, Contact, RoadSpec

_SIZE_M: dict[str, tuple[float, float]] = {
    "pole": (0.4, 0.4), "tree": (0.5, 0.5), "post": (0.3, 0.3), "sign": (0.3, 0.8), "signal": (0.4, 0.4),
    "mailbox": (0.4, 0.4), "hydrant": (0.4, 0.4), "fence": (0.3, 10.0), "guardrail": (0.4, 14.0), "rail": (0.4, 14.0),
    "wall": (0.5, 12.0), "barrier": (0.6, 14.0), "embankment": (1.5, 10.0), "building": (5.0, 5.0),
    "house": (5.0, 5.0), "box": (1.0, 1.0), "bush": (1.0, 1.0), "rock": (1.0, 1.0), "boulder": (1.5, 1.5),
    "railing": (0.3, 10.0), "snowbank": (1.5, 8.0), "dumpster": (1.8, 2.0), "bridge": (0.8, 12.0),
    "abutment": (1.0, 3.0), "ditch": (2.0, 12.0), "culvert": (1.0, 1.2), "berm": (1.5, 10.0), "hedge": (1.0, 6.0),
    "median": (1.0, 14.0), "curb": (0.3, 12.0), "divider": (0.6, 14.0), "island": (1.5, 8.0),
    "cable": (0.3, 14.0), "shrub": (1.0, 1.0), "trunk": (0.6, 0.6), "stump": (0.5, 0.5), "column": (0.8, 0.8),
    "curbing": (0.3, 12.0), "hole": (0.8, 0.8), "pothole": (0.6, 0.6), "swale": (2.0, 12.0), "pillar": (0.8, 0.8),
    "bollard": (0.2, 0.2), "garage": (5.0, 5.0), "shed": (3.0, 3.0),
}  # fmt: skip
"""Depth and width of things as a car meets them, metres; others are posts."""
_FIRM = frozenset((
    "tree", "trunk", "stump", "pole", "hydrant", "wall", "rock", "stone", "boulder", "border", "guardrail", "rail",
    "railing", "barrier", "embankment", "bridge", "abutment", "building", "house", "column", "pillar", "garage",
    "culvert",
))  # fmt: skip
"""Things that stay where they stand when a vehicle glances off them."""
_LOOSE = frozenset((
    "debris", "wheel", "tire", "cone", "barrel", "cover", "manhole", "glass", "metal", "branch", "limb", "ladder",
    "mattress", "cargo", "bag", "cart",
))  # fmt: skip
"""Pieces that a vehicle drives over, or pushes out of its way, without being stopped."""
_FLAT = frozenset((
    "curb", "curbing", "median", "island", "ditch", "hole", "pothole", "swale", "ground",
    "cover", "manhole", "drain", "grate", "bump", "hump", "plate",
))  # fmt: skip
"""Things on or in the ground: a vehicle drives over them, and they stay."""
_USUAL_M, _FALLEN_M = (0.4, 0.4), (0.5, 7.0)
"""Depth and width of other things, and of one that has fallen across the road."""
_LEAST_RUN_M = 4.0
"""Width from which a thing is so long that it can be struck twice."""
_LONG_M = 1.5
"""Width from which a thing stands along the road."""


def with_roadside(
    actors: Sequence[Actor], contacts: Sequence[Contact], facts: CrashFacts, most: tuple[int, int]
) -> tuple[tuple[Actor, ...], tuple[Contact, ...]]:
    """The actors and contacts with things and people that are struck besides, and second contacts of the first pair.

    Contacts stand in told order. `most`: actors and contacts in all.
    """
    joined, told = list(actors), _Told(len(contacts))
    words, lying = {other.id: other.word for other in facts.others}, {other.id: other.lies for other in facts.others}
    for impact in islice(_again(facts, contacts), 1):
        told.add(impact.after, _once_more(impact, contacts[0]))
    for vehicle, other, impact in _struck(facts, {a.id for a in actors}):
        driver = next((a for a in actors if a.id == vehicle), None)
        if driver is None or len(joined) >= most[0] or len(told.further) + len(contacts) >= most[1]:
            continue
        if all(a.id != other.id for a in joined):
            joined.append(_standing(other, driver, endwise=_is_met_endwise(impact, contacts)))
        words[other.id] = other.word
        told.add(impact.after, Contact(
            striker=vehicle, struck=other.id, striker_area=impact.actor_area or leading_end(driver.maneuver),
            struck_area="front" if actor_kind(other.kind).thing else "left",
        ))  # fmt: skip
    held = (_held(actor, words.get(actor.id, ""), lying.get(actor.id)) for actor in joined)
    return tuple(held), tuple(told.merged(contacts))


def _held(actor: Actor, word: str, lies: Lies | None = None) -> Actor:
    """The actor, as large as things of its name are; firm, loose or flat where things of that name are. What lies in
    the road is a piece that is driven over, as wide as the road where it lies across it."""
    named = word.lower().rpartition(" ")[2]
    if actor.record.thing and lies and (lies == "across" or named not in _FIRM):
        across = {"length_m": _FALLEN_M[0], "width_m": _FALLEN_M[1]} if lies == "across" else {}
        return actor.model_copy(update={"loose": True, "firm": False, **across})
    thing = actor.record.thing and not actor.length_m
    size = _SIZE_M.get(named) or _SIZE_M.get(named.rstrip("s"))
    if thing and size:
        actor = actor.model_copy(update={"length_m": size[0], "width_m": size[1]})
    kinds = {
        name
        for name, words in (("firm", _FIRM), ("loose", _LOOSE), ("flat", _FLAT))
        if {named, named.rstrip("s")} & words
    }
    return actor.model_copy(update=dict.fromkeys(kinds, True)) if actor.record.thing and kinds else actor


@dataclass
class _Told:
    """Further contacts, each with the number of contacts of vehicles that are told before it."""

    pairs: int
    further: list[tuple[int, Contact]] = field(default_factory=list)

    def add(self, after: int, contact: Contact) -> None:
        """Take a contact; in order among those told behind the same one."""
        self.further.append((min(after, self.pairs), contact))

    def merged(self, contacts: Sequence[Contact]) -> Iterator[Contact]:
        """All contacts in told order."""
        for number in range(len(contacts) + 1):
            yield from (contact for after, contact in self.further if after == number)
            yield from contacts[number : number + 1]


def _again(facts: CrashFacts, contacts: Sequence[Contact]) -> Iterator[ImpactTold]:
    """Impacts of the pair that touched first."""
    pair = {contacts[0].striker, contacts[0].struck} if contacts else set()
    return (impact for impact in facts.impacts if {impact.actor, impact.other} == pair)


def _once_more(impact: ImpactTold, first: Contact) -> Contact:
    """The same two touch a second time, as told."""
    own = impact.actor == first.striker
    sides = (impact.actor_area, impact.other_area) if own else (impact.other_area, impact.actor_area)
    return Contact(
        striker=first.striker, struck=first.struck,
        striker_area=sides[0] or first.striker_area, struck_area=sides[1] or first.struck_area,
    )  # fmt: skip


def _struck(facts: CrashFacts, taken: set[str]) -> Iterator[tuple[str, OtherFacts, ImpactTold]]:
    """(vehicle, what it strikes, as told), in order; the first contact of a lone vehicle is none of these."""
    taken, pairs = set(taken), {v.id for v in facts.vehicles}
    met: dict[tuple[str, str], tuple[OtherFacts, ImpactTold]] = {}
    for number, impact in enumerate(facts.impacts):
        if impact.other in pairs or (number == 0 and impact.other == _first_thing(facts)):
            continue
        before = met.get((impact.actor, impact.other))
        same = before[0] if before and _runs_on(before[1], impact) else None
        other = same or _known(facts, impact.other, taken)
        taken.add(other.id)
        met[impact.actor, impact.other] = other, impact
        yield impact.actor, other, impact


def _runs_on(before: ImpactTold, impact: ImpactTold) -> bool:
    """Whether a vehicle strikes one thing that runs along the road a second time, with another side."""
    size = _SIZE_M.get(impact.other.split()[-1], _USUAL_M)
    return (
        size[1] > _LEAST_RUN_M
        and None not in (before.actor_area, impact.actor_area)
        and (before.actor_area != impact.actor_area)
    )


def _first_thing(facts: CrashFacts) -> str | None:
    """The word of the thing that is met first of all: the first impact may be that one."""
    struck = facts.contacts[0].struck if facts.contacts else None
    return next((o.word.split()[-1] for o in facts.others if o.id == struck), None)


def _known(facts: CrashFacts, word: str, taken: set[str]) -> OtherFacts:
    """The crash's own record of a thing, or a new one with the next free number."""
    for other in facts.others:
        if other.id not in taken and other.word.split()[-1] == word:
            return other
    used, (letter, kind) = taken | {o.id for o in facts.others}, kind_of_word(word)
    free = next(f"{letter}{n}" for n in range(1, 99) if f"{letter}{n}" not in used)
    return OtherFacts(free, kind, word)


def _is_met_endwise(impact: ImpactTold, contacts: Sequence[Contact]) -> bool:
    """Whether a long thing is met at its end: by the front of a vehicle that drives on to another one."""
    return impact.before and bool(contacts) and impact.actor_area not in ("left", "right")


def _standing(other: OtherFacts, driver: Actor, *, endwise: bool = False) -> Actor:
    size = _SIZE_M.get(other.word.split()[-1], _USUAL_M) if actor_kind(other.kind).thing else (None, None)
    size = size[::-1] if endwise and size[1] and size[1] > _LONG_M else size
    kind: ActorKind = other.kind
    return Actor(
        id=other.id, kind=kind, road=driver.road, direction=driver.direction, maneuver="stopped",
        length_m=size[0], width_m=size[1],
    )  # fmt: skip


def in_gore(
    actors: Sequence[Actor], contacts: Sequence[Contact], gore: Mapping[str, str], spec: RoadSpec
) -> list[Actor]:
    """The actors with those of `gore` (vehicle -> `places.InGore`) put into the gore of the spec's first ramp."""
    ways = ways_of(spec)
    ramp = next((w for w in ways if w.road.kind == RAMP), None)
    if not gore or ramp is None:
        return list(actors)
    things = {c.struck for c in contacts[:1] if gore.get(c.striker) == "strikes"}
    found = []
    for actor in actors:
        how = gore.get(actor.id)
        if how in ("crosses", "leaves"):
            actor = actor.model_copy(update=_across(ramp, ways, how))
        thing = actor.id in things and actor.record.thing
        if how in ("crosses", "leaves", "stands") or thing:
            actor = actor.model_copy(update={"gore": True})
        found.append(actor)
    return found


def _across(ramp: Way, ways: Sequence[Way], how: str) -> dict[str, object]:
    """Start and exit road of a vehicle that crosses the gore of a ramp."""
    into = [w for w in ways if any(e is ramp for e in exits(w, ways)) and w.road.kind != RAMP]
    came = min(into, key=lambda w: abs(turn_of(w, ramp)), default=None)
    if came is None:
        onward = min(exits(ramp, ways), key=lambda w: abs(turn_of(ramp, w)), default=None)
        return {} if onward is None else {"exit_road": onward.road.id}
    on = [w for w in exits(came, ways) if w.road.kind != RAMP]
    ahead = min(on, key=lambda w: abs(turn_of(came, w)), default=None)
    goes = ramp if how == "leaves" or ahead is None else ahead
    return {"road": came.road.id, "direction": came.direction, "exit_road": goes.road.id, "maneuver": "straight"}
