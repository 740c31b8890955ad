"""The one verdict: which of several things decides it, and what its sentence says."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sgcad_core.account.notes import Note
from sgcad_core.account.records import Disagreement, Item
from sgcad_core.account.unread_clauses import unread_clauses
from sgcad_core.account.unread_text import _deeds as missed_deeds
from sgcad_core.account.verdict import (
    contradictions,
    guesses,
    implied_swings,
    odd_driving,
    places,
    sentence_of,
    untold_swerves,
    verdict_of,
)
from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.planner.lines.turning import WIDE
from sgcad_core.reading.reading import read
from tests.sgcad_core.planner.crash_scenes import network


def item(kind: str, field: str = "vehicles.V1.heading") -> Item:
    return Item(kind=kind, field=field, subject="V1", value="N", text=f"{kind} thing")  # type: ignore[arg-type]


def made(text: str):
    """A case of which only the reading matters."""
    reading = read(text)
    return SimpleNamespace(reading=reading, said=reading, told={fact.field: fact for fact in reading.facts})


DIFFER = Disagreement(
    field="vehicles.V1.maneuver", subject="V1", kept="straight", kept_by="model", kept_confidence=0.5, other="stopped",
    by="rules", confidence=0.9,
)  # fmt: skip


# ------------------------------------------------------------------ the word and the sentence
@pytest.mark.parametrize(("kinds", "verdict"), [
    (("has",), "whole"),
    (("has", "assumed"), "whole"),
    (("has", "guessed"), "guessed"),
    (("has", "contradicts", "guessed"), "contradicts"),
    (("unread", "contradicts", "guessed"), "unread"),
    (("has", "lacks", "unread"), "lacking"),
])  # fmt: skip
def test_the_gravest_thing_decides(kinds, verdict) -> None:
    assert verdict_of([item(kind) for kind in kinds], ()) == verdict


def test_readers_that_differ_leave_no_green() -> None:
    assert verdict_of([item("has")], (DIFFER,)) == "disputed"
    assert "readers differ (vehicles.V1.maneuver)" in sentence_of("disputed", [item("has")], (DIFFER,))


def test_a_sentence_of_motion_alone_is_named_and_costs_nothing() -> None:
    assert verdict_of([item("has"), item("unread", "text.motion")], ()) == "whole"
    assert verdict_of([item("has"), item("unread", "text.lane")], ()) == "unread"


def test_the_sentence_counts_and_names() -> None:
    said = sentence_of("lacking", [item("lacks"), item("has"), item("unread"), item("assumed")], ())
    assert (
        said == "lacks 1 of 2 things told (lacks thing); unread (unread thing): 1 of 2 things told are there, 1 assumed"
    )
    assert sentence_of("whole", [item("has")], ()).startswith("right as far as told: 1 of 1")


PASSED = (
    "The AV was eastbound and stopped. A van was westbound and passed the AV. The left side of the van struck the left "
    "side of the AV."
)


def deeds_missed(text: str, headings: dict[str, float]) -> list[str]:
    """The deeds of a text that a case lacks in which vehicles begin at some headings, radians."""
    case = made(text)
    case.tracks = {
        who: Trajectory(actor=who, t_s=np.zeros(1), x_m=np.zeros(1), y_m=np.zeros(1), heading_rad=np.array([heading]),
                        speed_mps=np.zeros(1))
        for who, heading in headings.items()
    }  # fmt: skip
    return [found.value for one in case.reading.sentences for found in missed_deeds(case, one)]


def test_one_that_goes_by_the_other_way_has_passed() -> None:
    assert deeds_missed(PASSED, {"V1": 0.0, "V2": np.pi}) == []
    assert deeds_missed(PASSED, {"V1": 0.0, "V2": 0.0})


def test_one_that_stands_over_the_line_has_begun_its_change_of_lanes() -> None:
    text = (
        "The AV was northbound in the right lane and began to change lanes to the left, then stopped, partially in the "
        "right lane and partially in the left lane. A truck struck the left side of the AV."
    )
    over = deeds_missed(text, {"V1": np.pi / 2, "V2": np.pi / 2})
    within = deeds_missed(text.replace("partially in the right lane and partially in the left lane", "in it"),
                          {"V1": np.pi / 2, "V2": np.pi / 2})  # fmt: skip
    assert over == []
    assert within


# ------------------------------------------------------------------ what it rests on
def test_a_contact_in_driving_that_nobody_tells_lacks() -> None:
    note = Note(
        kind="finding", subject="V2", text="[meeting] the declared contact comes about only by force at contacts[0]"
    )
    (found,) = odd_driving(made("V1 was northbound. V1 struck V2."), [note])
    assert (found.kind, found.subject, found.reason) == (
        "lacks",
        "V2",
        "the declared contact comes about only by force",
    )
    assert not [*odd_driving(made("V1 skidded and struck V2."), [note])]
    assert not [*odd_driving(made("V1 struck V2."), [note.model_copy(update={"text": "[netconvert] a default"})])]


@pytest.mark.parametrize(("x_m", "lacking"), [(1.75, []), (-1.75, ["V1"])])
def test_driving_out_of_the_lanes_that_nobody_tells_costs_the_verdict(x_m, lacking) -> None:
    t = 0.05 * np.arange(60)
    track = Trajectory(
        actor="V1", t_s=t, x_m=np.full(60, x_m), y_m=-150 + 15 * t, heading_rad=np.full(60, np.pi / 2),
        speed_mps=np.full(60, 15.0),
    )  # fmt: skip
    case = made("V1 was northbound. V1 struck V2.")
    case.graph, case.tracks = network("straight"), {"V1": track}
    info = ActorInfo(id="V1", type="car", length_m=4.7, width_m=1.8, maneuver="straight")
    case.scenario = SimpleNamespace(actors=(info,))
    found = [*places(case)]
    assert [one.subject for one in found] == lacking
    assert verdict_of([item("has"), *found], ()) == ("lacking" if lacking else "whole")
    assert {one.reason for one in found} <= {"3.0 s on the wrong side of the road before its contact"}


@pytest.mark.parametrize(("second", "unread"), [
    ("They have to brake to gain more time to merge.", ["text.evasion"]),
    ("A car behind them also brakes to avoid hitting them.", []),
])  # fmt: skip
def test_an_evasion_of_one_of_a_near_crash_that_was_not_read_costs_the_verdict(second, unread) -> None:
    text = f"The subject driver is merging. A van beside them does not move over. {second}"
    assert [one.field for one in unread_clauses(made(text)) if one.field == "text.evasion"] == unread


@pytest.mark.parametrize(("text", "unread"), [
    ("V1 was northbound in lane 2 of a four-lane road. The front of V1 struck the back of V2.", set()),
    ("V1 was northbound. The front of V1 struck the back of V2. V1 then rolled over.", set()),
    ("V1 was northbound. The front of V1 struck the back of V2. V3 was hit by flying components.", {"text.contact"}),
    ("V1 was northbound. V1 left the road and its right side contacted the ground as V1 tripped.", set()),
    ("The front of V1 struck the back of V2 where the lane 3 marker was.", {"text.lane"}),
    ("V1 was northbound. V1 struck V2 and came to rest on the right side of the roadway.", set()),
    ("V1 was northbound. The front of V1 struck the back of V2. Both rested near the point of impacts.", set()),
    ("V1 was northbound. The front of V1 struck the back of V2. V2 rotated one quarter turn clockwise.", set()),
    ("V1 was northbound in lane 2. V1 crossed over lane one and left the road on the right. V1 struck a tree.", set()),
])  # fmt: skip
def test_what_seems_told_and_was_not_read_is_named(text, unread) -> None:
    found = [*unread_clauses(made(text))]
    assert {one.field for one in found} >= unread
    assert {one.field for one in found} <= unread | {"text.motion", "text.side"}
    for one in found:
        assert 0 <= one.start < one.end <= len(text)
        assert one.kind == "unread"


CROSSING = "V1 was northbound on a road and V2 was eastbound on an intersecting road. "
STRUCK = " The front of V2 struck the left side of V1."


@pytest.mark.parametrize(("before", "told", "after", "heard"), [
    (CROSSING, "V1 and V2 entered the intersection simultaneously.", STRUCK, True),
    (CROSSING, "V1 and V2 entered the intersection side by side.", STRUCK, False),
    ("V1 was northbound and V2 behind it.", "V1 and V2 entered the intersection.", " V2 struck the back of V1.", True),
    (CROSSING + "V1 turned left.", "V1 began to turn left at the intersection.", STRUCK, True),
    ("V1 and V2 were northbound.", "V1 was traveling behind V2.", " The front of V1 struck the back of V2.", True),
    ("V1 and V2 were northbound.", "V2 was traveling behind V1.", " The front of V1 struck the back of V2.", False),
    ("V1 and V2 were northbound.", "V2 was ahead of V1.", " The front of V1 struck the back of V2.", True),
    ("V1 and V2 were northbound.", "V1 was ahead of V2.", " The front of V1 struck the back of V2.", False),
    (CROSSING, "V1 was passing through the intersection at the same time as V2.", STRUCK, True),
    (CROSSING + "V1 was towing a trailer.", "V1 was towing a trailer.", STRUCK, True),
    ("V1 was northbound, leaving a driveway. V2 was eastbound.", "V1 exited the driveway.", STRUCK, True),
    ("V1 was northbound.", "A deer ran from the right into the lane of V1.", " V1 struck the deer.", True),
    ("V1 was northbound.", "A dog crossed the path of V1.", " V1 struck a tree.", False),
])  # fmt: skip
def test_what_is_only_told_once_more_is_not_unread(before, told, after, heard) -> None:
    text = before + " " + told + after
    one = made(text)
    start = text.index(told)
    one.reading = replace(one.reading, timeline=tuple(a for a in one.reading.timeline if a.start != start),
                          facts=tuple(f for f in one.reading.facts if f.start != start))  # fmt: skip
    assert any(item.field == "text.motion" and item.start == start for item in unread_clauses(one)) != heard


def test_a_field_of_which_two_things_are_told_contradicts_itself() -> None:
    found = [*contradictions(made("V1 was traveling north. V1 was traveling south. V1 struck V2, which was parked."))]
    assert [one.field for one in found] == ["vehicles.V1.heading"]
    assert not [*contradictions(made("V1 was traveling north. V1 struck V2, which was parked."))]


TURNS = (
    "V1 was northbound in lane two of a {} road. V2 was traveling in lane one of the same road. V1 turned right and "
    "the front of V2 struck the right side of V1."
)


@pytest.mark.parametrize(("text", "guessed"), [
    ("V1 was northbound. V2 was eastbound. The front of V1 struck the left side of V2.", []),
    ("V1 was northbound. The front of V1 struck the left side of V2.", ["vehicles.V2.heading"]),
    ("V1 was northbound. The front of V1 struck the back of V2.", []),
    ("V1 was northbound. The front of V1 struck the left side of V2, which was parked.", []),
    ("The subject vehicle is in the left lane. A van changes into the subject vehicle's lane.", []),
    ("The subject vehicle is in the left lane. A van is at the corner and the subject brakes to avoid it.",
     ["vehicles.V2.heading"]),
    (TURNS.format("two-lane"), ["vehicles.V2.heading"]),
    (TURNS.format("one-way"), []),
])  # fmt: skip
def test_a_heading_that_nobody_tells_is_a_guess(text, guessed) -> None:
    assert [one.field for one in guesses(made(text))] == guessed


# ------------------------------------------------------------------ swerves
@pytest.mark.parametrize(("text", "counts"), [
    ("V1 was northbound. V2 was southbound. The front of V1 struck the left side of V2.", 1),
    ("V1 was northbound. V2 was southbound. V2 swerved to the left. The front of V1 struck the left side of V2.", 0),
    ("V1 was northbound. V2 was southbound. V2 lost control. The front of V1 struck the left side of V2.", 0),
])  # fmt: skip
def test_a_swerve_that_nobody_tells_costs_the_verdict(text, counts) -> None:
    note = Note(kind="plan", subject="V2", text="V2 steers aside before contact")
    assert len(list(untold_swerves(made(text), [note]))) == counts


def test_other_notes_are_no_swerves() -> None:
    note = Note(kind="plan", subject="V2", text="V2 drives slower than stated")
    assert not list(untold_swerves(made("V1 was northbound. V2 was southbound. V1 struck V2."), [note]))


@pytest.mark.parametrize(("told", "unread"), [
    ("V2 was traveling south on a five-lane roadway.", False),
    ("V2 was traveling south on a seven-lane roadway.", True),
    ("V1 was in lane two, and V2 was ahead.", False),
    ("V1 crossed the left lane line.", False),
])  # fmt: skip
def test_lanes_that_are_known_from_another_sentence_are_not_unread(told, unread) -> None:
    text = f"V1 was traveling south in lane two of a five-lane road and crossed the centerline. {told} V1 struck V2."
    one = made(text)
    kept = tuple(fact for fact in one.reading.facts if fact.start is None or fact.start < text.index(told))
    one.reading = replace(one.reading, facts=kept)
    assert any(item.field == "text.lane" for item in unread_clauses(one)) == unread


def test_a_turn_that_must_swing_wide_is_an_assumption_with_its_reason():
    notes = [
        Note(kind="plan", subject="V1", text=f"V1 {WIDE}"),
        Note(kind="plan", subject="V2", text="V2 leaves its lane"),
    ]
    (found,) = implied_swings(notes)
    assert (found.kind, found.field) == ("assumed", "vehicles.V1.line")
    assert "no line within its lanes" in found.reason


@pytest.mark.parametrize(("text", "twice"), [
    ("V1 was westbound, attempting to turn left heading southbound. V2 was eastbound. V1 struck V2.", set()),
    ("V1 was southbound. V2 was parked in the southbound side of the road facing northbound. V1 struck V2.", set()),
    ("V1 was northbound. V1 traveled to its right and departed the east road edge. V1 struck a pole.", set()),
    ("V1 was southbound on a road with two lanes of travel northbound. The front of V1 struck V2.", set()),
    ("V1 was traveling north. V1 was traveling west. The front of V2 struck the right side of V1.", {"V1"}),
])  # fmt: skip
def test_a_way_out_of_a_turn_and_a_lane_or_an_edge_are_no_second_heading(text, twice) -> None:
    assert {one.subject for one in contradictions(made(text)) if one.field.endswith(".heading")} == twice
