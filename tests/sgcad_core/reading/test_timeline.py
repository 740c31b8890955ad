"""The timeline of a report: order, phases, and what follows from it."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.reading import read
from sgcad_core.records.facts import Fact
from sgcad_core.records.timeline import PHASES, Act, as_settled, of_actor, starts_from_rest

WAITED = (
    "V1 was northbound on a two-lane road. V2 was stopped at a stop sign, facing east. V2 then pulled into the "
    "intersection and the front of V1 struck the right side of V2. V2 spun clockwise and came to rest on the shoulder."
)


def kinds(text: str, actor: str) -> list[tuple[str, str]]:
    return [(act.phase, act.kind) for act in of_actor(read(text).timeline, actor)]


def test_acts_stand_in_the_order_of_the_crash() -> None:
    assert kinds(WAITED, "V2") == [
        ("before", "approach"), ("before", "stopped"), ("before", "starts"), ("after", "spins"), ("after", "rests"),
    ]  # fmt: skip
    (hit,) = [act for act in read(WAITED).timeline if act.phase == "at"]
    assert (hit.actor, hit.kind, hit.other, hit.value) == ("V1", "contact", "V2", "front")


def test_every_act_points_to_the_sentence_that_tells_it() -> None:
    stop = next(act for act in read(WAITED).timeline if act.kind == "stopped")
    assert WAITED[stop.start : stop.end] == "V2 was stopped at a stop sign, facing east."
    assert stop.words in WAITED


@pytest.mark.parametrize(("told", "starts"), [
    ("V2 was stopped at the sign and then entered the intersection.", True),
    ("V2 stopped, waited, and began to turn left.", True),
    ("V2 was stopped behind a truck and began to pass it.", True),
    ("V2 was stopped at the sign.", False),
    ("V2 entered the intersection.", False),
])  # fmt: skip
def test_who_stood_and_went_on_starts_from_rest(told: str, starts: bool) -> None:
    found = read(f"V1 was traveling north. {told} The front of V1 struck V2.")
    assert starts_from_rest(of_actor(found.timeline, "V2")) == starts
    assert (("V2" in found.crash.driven) and found.crash.driven["V2"].from_rest) == starts


@pytest.mark.parametrize(("hit", "goes"), [
    ("The front of V2 struck the right side of V1.", True),
    ("The front of V1 struck the left side of V2.", True),
    ("The front of V1 struck the back of V2.", False),
    ("The front of V1 struck the front of V2.", False),
])  # fmt: skip
def test_who_stood_must_have_gone_where_the_contact_needs_it(hit: str, goes: bool) -> None:
    found = read(f"V1 was traveling north. V2 was eastbound and stopped for the stop sign. {hit}")
    v2 = found.crash.vehicle("V2")
    assert v2 is not None
    assert (v2.maneuver, v2.from_stop, v2.maneuver_stated) == (("straight", True, False) if goes else
                                                               ("stopped", False, True))  # fmt: skip
    assert ("starts" in [act.kind for act in of_actor(found.timeline, "V2")]) == goes


def test_a_plan_to_turn_is_told_as_meant() -> None:
    acts = of_actor(read("V1 was northbound, waiting to turn left. V2 struck the rear of V1.").timeline, "V1")
    assert [(act.kind, act.meant) for act in acts if act.kind == "turn_left"] == [("turn_left", True)]


def test_what_a_person_says_takes_the_place_of_the_act_at_the_crash() -> None:
    acts = read(WAITED).timeline
    said = Fact(
        field="vehicles.V2.maneuver", value="turn_left", basis="person", status="stated", rule="facts.yaml",
        confidence=1.0,
    )  # fmt: skip
    (decided,) = [act for act in as_settled(acts, [said]) if act.actor == "V2" and act.decides]
    assert (decided.kind, decided.basis, decided.phase) == ("turn_left", "person", "before")
    again = as_settled(as_settled(acts, [said]), [said])
    assert again == as_settled(acts, [said])


_DOES = st.sampled_from([
    "was traveling north", "stopped at the sign", "turned left", "slowed", "entered the intersection",
    "was struck by V3", "struck V3", "came to rest facing east", "changed lanes to the right",
])  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(["V1", "V2", "V3"]), _DOES), min_size=1, max_size=7))
def test_phases_never_run_backward_and_every_place_is_in_the_text(told: list[tuple[str, str]]) -> None:
    text = " ".join(f"{who} {does}." for who, does in told)
    acts = read(text).timeline
    order = [PHASES.index(act.phase) for act in acts]
    assert order == sorted(order)
    for act in acts:
        assert isinstance(act, Act)
        assert act.start is None or 0 <= act.start < (act.end or 0) <= len(text)


@pytest.mark.parametrize(("text", "thin"), [
    ("V1 hit V2. There was minor damage.", True),
    ("V1 hit V2 in the rear.", False),
    ("V1 was northbound. V1 hit V2.", False),
    ("V1 turned left and hit V2.", False),
    ("V1 hit V2 on a two-lane road.", False),
    ("V1 hit a tree.", False),
])  # fmt: skip
def test_a_report_that_tells_only_the_pair_is_refused(text: str, thin: bool) -> None:
    gap = read(text).crash.gap
    assert (gap is not None and "only who touched whom" in gap.reason) == thin


def test_one_of_a_report_without_numbers_that_strikes_a_flank_across_its_way_has_started() -> None:
    found = read(
        "A van stopped for a stop sign, heading south. The van then proceeded through it, and a taxi that "
        "was stopped facing east struck the right side of the van with its front."
    )
    taxi = found.crash.vehicle("V2")
    assert taxi is not None
    assert (taxi.maneuver, taxi.from_stop) == ("straight", True)
