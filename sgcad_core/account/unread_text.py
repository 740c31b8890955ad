"""Things that the text names and no fact holds: unknown numbers, further vehicles, people, animals, places, contacts.

Matches words in the sentences independently of the reading, so that what the readers missed is reported
as lacking. Sentences that retell or judge (interviews, codes, injuries) are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.kinds import DRIVEWAY, JUNCTIONS, PARKING_LOT, ROUNDABOUT, actor_kind, is_vehicle_id
from sgcad_core.reading.actors.people_objects import kind_of_word
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.normalise import NUMBERS, Sentence
from sgcad_core.reading.text.sentence_roles import STORY_ROLES, is_impact
from sgcad_core.records.course import CourseTold
from sgcad_core.roads.areas.roadside import roadsides
from sgcad_core.roads.compiled_facts import junctions

_CALLED, _COUNTED, _FURTHER, _ANIMAL, _MANY_LEGS, _INTRODUCED = (
    rule("account.called"), rule("account.counted"), rule("account.further"), rule("account.animal"),
    rule("account.many_legs"), rule("account.introduced"),
)  # fmt: skip
_TURNING = rule("deeds.turning")
_ASIDE = ("backing", "lane_change", "merge", "overtaking", "crossing_centerline", "turn_", "u_turn", "departing_road")
_SATISFIED_BY: dict[str, tuple[str, ...]] = {
    "turn_left": ("turn_left", "u_turn", "merge"), "turn_right": ("turn_right", "merge"), "u_turn": ("u_turn",),
    "lane_change_left": _ASIDE, "lane_change_right": _ASIDE, "lane_change": _ASIDE, "overtaking": _ASIDE,
    "merge": _ASIDE, "crossing_centerline": _ASIDE, "departing_road_left": _ASIDE, "departing_road_right": _ASIDE,
    "backing": ("backing",),
}  # fmt: skip
"""Act in the text -> prefixes of the maneuvers that show it; other acts occur within many maneuvers."""

_AGAINST = 0.7
"""Cosine of the angle between two that come against each other."""
_PAIR = 2
"""Vehicles of a crash that has no further ones."""


def unread_items(made: ExecutedCase) -> Iterator[Item]:
    """Lacking items of the narrative's sentences, each thing once."""
    story = [s for s in made.reading.sentences if s.role in STORY_ROLES]
    found: dict[str, Item] = {}
    for sentence in story:
        for item in _of_sentence(made, sentence):
            found.setdefault(f"{item.field} {item.value}", item)
    yield from found.values()


def _of_sentence(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    yield from _numbers(made, sentence)
    yield from _called(made, sentence)
    yield from _further(made, sentence)
    yield from _served(made, sentence)
    yield from _crowd(made, sentence)
    yield from _struck(made, sentence)
    yield from _things(made, sentence)
    yield from _places(made, sentence)
    yield from _ground(made, sentence)
    yield from _contact(made, sentence)
    yield from _deeds(made, sentence)


def _lacks(sentence: Sentence, what: str, value: str, text: str, reason: str) -> Item:
    return Item(
        kind="lacks", field=f"text.{what}", subject="", value=value, text=text, reason=reason,
        start=sentence.start, end=sentence.end,
    )  # fmt: skip


def _undrawn(sentence: Sentence, words: str) -> Item:
    """A road user who is named and is not in the scenario."""
    return _lacks(sentence, "further", words.lower(), f"{words!r} is named", "it is not in the scenario")


# ------------------------------------------------------------------ actors
def _numbers(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Numbered vehicles that were not read, and counts above the number of vehicles in the scenario."""
    known = {v.id for v in made.reading.crash.vehicles} | set(made.tracks)
    for name in sorted(made.reading.named_in(sentence) - known):
        words = _introduced(made, name)
        letter = kind_of_word(words.lower())[0] if words else "O"
        if letter not in "OV" and any(one.startswith(letter) for one in made.tracks):
            continue  # a person or an animal beside the contact, drawn with an id of its own
        yield _lacks(
            sentence,
            "vehicle",
            name,
            f"{words!r} is named" if words else f"{name} is named",
            "it is not in the scenario",
        )
    for match in _COUNTED.finditer(sentence.text):
        count = NUMBERS.get(match["n"].lower()) or int(match["n"])
        there = sum(is_vehicle_id(name) for name in made.tracks)
        if count > there:
            text = f"{count} vehicles are told ({match[0]!r})"
            yield _lacks(sentence, "vehicles", str(count), text, f"the scenario has {there}")


def _introduced(made: ExecutedCase, name: str) -> str:
    """The words by which a report without numbers first names an actor; empty where no sentence has them."""
    told = (m for s in made.reading.sentences for m in _INTRODUCED.finditer(s.text))
    return next((m["words"] for m in told if made.reading.actor(m["id"]) == name), "")


def _called(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """What a vehicle is said to be, where no word of it is of a kind that there is and a usual one is drawn."""
    for match in _CALLED.finditer(sentence.text):
        name = made.reading.actor(match["id"])
        fact = made.told.get(f"vehicles.{name}.kind")
        if fact is not None and fact.basis == "default":
            words = match["apposed"] or match["said"]
            text, reason = f"{name} is called {words!r}", f"no such kind is known: a {fact.value} is drawn"
            yield _lacks(sentence, "kind", words, text, reason)


def _further(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Vehicles without a number, in reports that number the others, where the scenario has none beside these."""
    numbered = {v.id for v in made.reading.crash.vehicles}
    if made.reading.crash.unnumbered or any(is_vehicle_id(name) for name in made.tracks.keys() - numbered):
        return
    for match in _FURTHER.finditer(sentence.text):
        yield _undrawn(sentence, match[0])


def _served(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Vehicles of services, and vehicles that others wait for or pass, that have no number and are not drawn."""
    numbered = {v.id for v in made.reading.crash.vehicles}
    if made.reading.crash.unnumbered or any(is_vehicle_id(name) for name in made.tracks.keys() - numbered):
        return
    kinds = {actor.type for actor in made.scenario.actors}
    for wording in (rule("account.served"), rule("account.passed")):
        for match in wording.finditer(sentence.text):
            words = match["kind"].lower()
            if not any(kind in words for kind in kinds - {"car"}):
                yield _undrawn(sentence, words)


def _crowd(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Queues, standing traffic and one more vehicle, where none is drawn beside those of the first contact; people who
    are waited for; and doors that touch something, which no scenario has."""
    vehicles = [actor for actor in made.scenario.actors if actor_kind(actor.type).drives]
    if len(vehicles) <= _PAIR and (match := rule("account.crowd").search(sentence.text)):
        yield _undrawn(sentence, match[0])
    if made.reading.crash.unnumbered and len(vehicles) <= _PAIR:
        for match in rule("account.another").finditer(sentence.text):
            yield _undrawn(sentence, match[0])
    if not any(name[0] in "PBA" for name in made.tracks):
        for wording in (rule("account.waited_for"), rule("company.avoided")):
            if match := wording.search(sentence.text):
                who = next(filter(None, match.groups())).lower()
                yield _lacks(sentence, "further", who, f"{match[0]!r} is told", "none is in the scenario")
                break
    if match := rule("account.door").search(sentence.text):
        yield _lacks(sentence, "struck", "door", f"{match[0]!r} in a contact", "no door is drawn open")


def _struck(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """People and animals in sentences about a contact, where the scenario has no actor of their kind."""
    if not is_impact(sentence.text):
        return
    kinds = [(user, str(user.yields["letter"])) for user in of_role("road_user")]
    for user, letters in [*kinds, (_ANIMAL, "AO")]:
        match = user.search(sentence.text)
        if match and not any(name[0] in letters for name in made.tracks):
            yield _lacks(sentence, "struck", match[0].lower(), f"{match[0]!r} in a contact", "not in the scenario")


def _things(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Things that are told to be struck, where the report's contacts have none of that name."""
    words = _met(made)
    for match in rule("account.to_thing").finditer(sentence.text):
        thing = match["thing"].lower()
        if not any(thing.split()[-1].rstrip("s") in word or word in thing for word in words):
            yield _lacks(sentence, "struck", thing, f"{thing!r} in a contact", "not in the scenario")


def _met(made: ExecutedCase) -> set[str]:
    """The words of all things, people and animals of the report's contacts; each has its own item."""
    crash = made.reading.crash
    return {other.word.lower() for other in crash.others} | {impact.other.lower() for impact in crash.impacts}


# ------------------------------------------------------------------ places
def _places(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Named kinds of junctions that differ from the compiled one."""
    legs = {len(found) for found in junctions(made.graph)}
    for match in _MANY_LEGS.finditer(sentence.text):
        count = NUMBERS.get(match["n"].lower()) or int(match["n"])
        if count not in legs:
            yield _lacks(sentence, "junction", str(count), f"a junction of {count} legs", "drawn with fewer")
    if made.reading.roads.junction.kind == ROUNDABOUT or made.graph.circles:
        return
    circle = next(rule(record.rule) for record in JUNCTIONS if record.round)
    if named := circle.search(sentence.text):
        yield _lacks(sentence, "junction", ROUNDABOUT, f"{named[0]!r} is named", "no roundabout is drawn")


def _ground(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Medians, driveways and ground beside the road that are named, where none is drawn."""
    spec = made.network.spec
    roads = spec.roads if spec else ()
    lot = made.reading.roads.junction.kind == PARKING_LOT
    there = {
        "account.median": any(r.median != "none" for r in roads) or _parted(made),
        "account.drive": lot or any(r.kind == DRIVEWAY or r.alley for r in roads),
    }
    for wording in (rule("account.median"), rule("account.drive")):
        if not there[wording.id] and (match := wording.search(sentence.text)):
            yield _not_drawn(sentence, match[0])
    words = _met(made)
    drawn = {strip.kind for strip in roadsides(made.graph)}
    for kind in of_role("ground_beside"):
        match = kind.search(sentence.text) if kind.yields["ground"] != "curb" else None  # one parks along it, too
        if match and kind.yields["ground"] not in drawn and not any(match[0].lower() in word for word in words):
            yield _not_drawn(sentence, match[0])
    for match in rule("account.ground").finditer(sentence.text):
        if not any(match[0].lower() in word for word in words):
            yield _not_drawn(sentence, match[0])


def _not_drawn(sentence: Sentence, words: str) -> Item:
    return _lacks(sentence, "ground", words.lower(), f"{words!r} is named", "none is drawn")


def _parted(made: ExecutedCase) -> bool:
    """Whether a road is drawn as two one-way roads beside each other."""
    spec = made.network.spec
    return spec is not None and any(not (road.lanes_forward and road.lanes_backward) for road in spec.roads)


# ------------------------------------------------------------------ contacts and acts
def _contact(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """Two vehicles in a sentence about a contact, without a contact in the reading."""
    if sentence.role != "impact" or made.reading.crash.near_crash:
        return
    names = made.reading.named_in(sentence)
    crash = made.reading.crash
    pairs = [{c.striker, c.struck} for c in crash.contacts if c.stated] + [{i.actor, i.other} for i in crash.impacts]
    carried = any(f.start == sentence.start and f.field.startswith(("contacts", "impacts")) for f in made.reading.facts)
    if len(names) > 1 and not carried and not any(pair <= names for pair in pairs):
        who = " and ".join(sorted(names))
        yield _lacks(sentence, "contact", who, f"a contact of {who} seems told", "nobody read it")


def _deeds(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """A turn, lane change or the like before the first contact that no named vehicle makes or intends."""
    names = made.reading.named_in(sentence)
    vehicles = [v for v in made.reading.crash.vehicles if v.id in names]
    if not vehicles or sentence.start > _first_told(made):
        return
    done = {str(word) for v in vehicles for word in (v.maneuver, v.meant) if word}
    leaves = any(made.reading.crash.courses.get(v.id, CourseTold()).departs for v in vehicles)
    done |= {"departing_road"} if made.reading.lost_control or leaves else set()
    done |= {f"lane_change_{v.straddles}" for v in vehicles if v.straddles}
    done |= {"overtaking"} if _go_past(made, [v.id for v in vehicles]) else set()
    for deed, words in _told_deeds(sentence.text):
        if not any(made_so.startswith(_SATISFIED_BY.get(deed, (deed,))) for made_so in done):
            who = " and ".join(v.id for v in vehicles)
            yield _lacks(sentence, "deed", f"{who} {deed}", f"{who}: {words!r}", "nobody there does so in the scenario")


def _go_past(made: ExecutedCase, names: Sequence[str]) -> bool:
    """Whether two of the vehicles come against each other: one that is said to pass the other one goes by it."""
    first = [float(made.tracks[name].heading_rad[0]) for name in names if name in made.tracks]
    return any(math.cos(one - other) < -_AGAINST for one, other in combinations(first, 2))


def _told_deeds(text: str) -> Iterator[tuple[str, str]]:
    """(act, words) of the acts that a sentence states."""
    if match := _TURNING.search(text):
        side = next((g for name, g in match.groupdict().items() if name.startswith("side") and g), "")
        yield f"turn_{side.lower()}", match[0].strip()
    for deed in of_role("deed"):
        if deed.yields["deed"] in _SATISFIED_BY and (match := deed.search(text)):
            yield str(deed.yields["deed"]), match[0].strip()


def _first_told(made: ExecutedCase) -> int:
    """Start of the sentence of the first contact; beyond the text's end without one."""
    fact = made.told.get("contacts.0.striker")
    return fact.start if fact and fact.start is not None else len(made.reading.narrative) * 2
