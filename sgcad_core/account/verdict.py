"""The one verdict on a case, in a word and in a sentence, and what it rests on beside what is told and lacking.

A scenario is called right as far as told only where nothing that is told lacks, nothing that seems told is unread, the
report does not contradict itself, and the crash does not turn on a guess.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.notes import Note
from sgcad_core.account.records import Disagreement, Item, Kind, Verdict, is_of_map
from sgcad_core.account.words import phrase
from sgcad_core.kinds import ACROSS_LANES, ALLEY, DRIVEWAY, Maneuver
from sgcad_core.metrics.untold_places import untold_places
from sgcad_core.planner.encounter.maneuver_choices import UNTOLD
from sgcad_core.planner.lines.turning import WIDE
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.provenance.crash_provenance import CONFIDENCE
from sgcad_core.records.course import CourseTold
from sgcad_core.records.facts import Fact

ORDER: tuple[Kind, ...] = ("lacks", "unread", "contradicts", "guessed", "has", "assumed")
_VERDICTS: dict[Kind, Verdict] = {
    "lacks": "lacking", "unread": "unread", "contradicts": "contradicts", "guessed": "guessed",
}  # fmt: skip
_ODD = ("[meeting]", "[drivable]")
"""Beginnings of the notes by which validators doubt a contact that was brought about."""
_BESIDE = "text.motion"
"""On 278 development reports those with such a sentence were right as often as the others (.68 against .56)."""
_SHOWN = 3
_STRAIGHT_ON: tuple[Maneuver, ...] = ("straight", "slowing", "negotiating_curve", "other")
"""Maneuvers to which no steering belongs."""


def verdict_of(items: Sequence[Item], differing: Sequence[Disagreement]) -> Verdict:
    """The gravest thing that the items show; a sentence of motion that adds nothing to what was read costs nothing."""
    kinds = {item.kind for item in items if item.field != _BESIDE}
    found = next((verdict for kind, verdict in _VERDICTS.items() if kind in kinds), None)
    return found or ("disputed" if differing else "whole")


def sentence_of(verdict: Verdict, items: Sequence[Item], differing: Sequence[Disagreement]) -> str:
    """The verdict in one sentence: what lacks, what is unread, where the report contradicts itself, what is guessed."""
    of = {kind: [item for item in items if item.kind == kind] for kind in ORDER}
    on_map = [item for item in of["contradicts"] if is_of_map(item.field)]
    itself = [item for item in of["contradicts"] if item not in on_map]
    told = len(of["has"]) + len(of["lacks"])
    parts = {
        f"lacks {len(of['lacks'])} of {told} things told": of["lacks"], "unread": of["unread"],
        "the report contradicts itself": itself, "the map has it otherwise": on_map, "guessed": of["guessed"],
    }  # fmt: skip
    said = [f"{name} ({_first(some)})" for name, some in parts.items() if some]
    said += [f"readers differ ({'; '.join(one.field for one in differing[:_SHOWN])})"] if differing else []
    start = "right as far as told" if verdict == "whole" else "; ".join(said)
    return f"{start}: {len(of['has'])} of {told} things told are there, {len(of['assumed'])} assumed"


def _first(items: Sequence[Item]) -> str:
    more = f"; and {len(items) - _SHOWN} more" if len(items) > _SHOWN else ""
    return "; ".join(item.text for item in items[:_SHOWN]) + more


# ------------------------------------------------------------------ what else costs the verdict
def odd_driving(made: ExecutedCase, notes: Sequence[Note]) -> Iterator[Item]:
    """A lack where the contact comes about only in driving that is not told."""
    if made.said.lost_control:
        return
    for note in notes:
        if note.kind == "finding" and note.text.startswith(_ODD):
            yield Item(
                kind="lacks", field="contacts.0.driving", subject=note.subject, value=None,
                text="the first contact in ordinary driving", reason=note.text.partition("] ")[2].partition(" at ")[0],
            )  # fmt: skip
            return


def untold_swerves(made: ExecutedCase, notes: Sequence[Note]) -> Iterator[Item]:
    """A lack for each vehicle that swerves or skids into the contact where nothing of the kind is told of it."""
    for note in notes:
        words = next((words for words in UNTOLD if note.text == f"{note.subject} {words}"), None)
        told = made.said.crash.driven.get(note.subject, CourseTold())
        vehicle = made.reading.crash.vehicle(note.subject)
        aside = vehicle is not None and vehicle.maneuver not in _STRAIGHT_ON
        leaves = aside or told.steers or told.lost_control or told.departs or told.moves
        if note.kind == "plan" and words and not leaves and made.reading.crash.near_crash is None:
            yield Item(
                kind="lacks", field=f"vehicles.{note.subject}.driving", subject=note.subject, value=None,
                text=f"{note.subject} in ordinary driving", reason=f"it {words}, which is not told",
            )  # fmt: skip


def implied_swings(notes: Sequence[Note]) -> Iterator[Item]:
    """An assumption for each turn that swings wide because no line within the lanes meets the other one on the told
    sides. What is driven on the wrong side before it turns, or behind the turn, lacks all the same (`places`)."""
    for note in notes:
        if note.kind == "plan" and note.text == f"{note.subject} {WIDE}":
            yield Item(
                kind="assumed", field=f"vehicles.{note.subject}.line", subject=note.subject, value=None,
                text=f"{note.subject} swings wide in its turn",
                reason="no line within its lanes meets the other one on the told sides",
            )  # fmt: skip


def places(made: ExecutedCase) -> Iterator[Item]:
    """A lack for each vehicle that drives out of the lanes of its direction before its contact, and is not told to."""
    told = made.said.crash, made.said.lost_control
    for one in untold_places(made.graph, [*made.tracks.values()], made.scenario.actors, *told):
        yield Item(
            kind="lacks", field=f"vehicles.{one.actor}.place", subject=one.actor, value=None, seen=one.place,
            text=f"{one.actor} in a lane of its direction", reason=one.words(),
        )  # fmt: skip


def contradictions(made: ExecutedCase) -> Iterator[Item]:
    """Stated facts of motion and contacts of which the report also says something else."""
    for fact in made.reading.facts:
        if fact.status == "stated" and fact.basis == "text" and _disputed(fact):
            subject = fact.field.split(".")[1] if fact.field.startswith("vehicles.") else ""
            yield Item(
                kind="contradicts", field=fact.field, subject=subject, value=fact.value,
                text=phrase(fact.field, fact.value), reason="the report also says something else",
                start=fact.start, end=fact.end,
            )  # fmt: skip


def _disputed(fact: Fact) -> bool:
    """Whether the reading took one of several values that were told."""
    sure = (CONFIDENCE.stated, CONFIDENCE.quoted)
    return any(abs(fact.confidence - one * CONFIDENCE.conflict) < 1e-3 for one in sure)


def guesses(made: ExecutedCase) -> Iterator[Item]:
    """Initial headings of vehicles of the first contact that neither the text nor its other words tell."""
    crash = made.reading.crash
    first = next(iter(crash.contacts), None)
    if first is None or len(crash.vehicles) < 2:
        return
    for name in (first.striker, first.struck):
        vehicle, other = crash.vehicle(name), crash.vehicle(first.struck if name == first.striker else first.striker)
        if vehicle is None or vehicle.heading_stated or vehicle.maneuver == "parked" or _backs_out(made, vehicle):
            continue
        if _is_base(made, vehicle) or (other and _changes_lanes(vehicle, other)) or _on_one_way(made, name):
            continue
        if not _told_beside(made, name) and not _from_behind(first.striker_area, first.struck_area):
            yield Item(
                kind="guessed", field=f"vehicles.{name}.heading", subject=name, value=vehicle.heading,
                text=phrase(f"vehicles.{name}.heading", vehicle.heading), reason="told nowhere",
            )  # fmt: skip


def _is_base(made: ExecutedCase, vehicle: VehicleFacts) -> bool:
    """Whether no heading is told at all and it is the first vehicle: then only those of the others against it count."""
    return not made.reading.crash.oriented and vehicle is made.reading.crash.vehicles[0]


def _changes_lanes(one: VehicleFacts, other: VehicleFacts) -> bool:
    """Whether two drive one way and one of them changes lanes, merges or passes: that is done in the lanes of one
    direction."""
    return one.heading == other.heading and any(v.maneuver in ACROSS_LANES for v in (one, other))


def _backs_out(made: ExecutedCase, vehicle: VehicleFacts) -> bool:
    """Whether it backs out of a driveway whose side is told: its front points into the driveway."""
    junction = made.reading.roads.junction
    return vehicle.maneuver == "backing" and junction.kind in (DRIVEWAY, ALLEY) and junction.stem_stated


def _told_beside(made: ExecutedCase, name: str) -> bool:
    """Whether words such as "behind V2" or "the opposite direction" tell the heading against another vehicle's."""
    fact = made.told.get(f"vehicles.{name}.heading")
    return fact is not None and fact.start is not None


def _on_one_way(made: ExecutedCase, name: str) -> bool:
    """Whether it is told to be on a one-way road, which has one direction."""
    return any(name in road.vehicles and road.lanes.one_way for road in made.reading.roads.roads)


def _from_behind(striker: str, struck: str) -> bool:
    """Whether the sides alone tell that both drove one way."""
    return {striker, struck} == {"front", "back"}
