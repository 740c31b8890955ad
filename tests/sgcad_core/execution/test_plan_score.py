"""The reading that our own checks doubt least is kept, at its price, and what was tried is told."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from sgcad_core.case.records import Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.plan_score import doubt, least_doubted
from sgcad_core.planner import plan
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import BehaviorSpec, Contact, NearCrash
from tests.sgcad_core.planner.aftermath.test_rest_fit import crossing
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor

TEXT = "V1 was eastbound. V2 was southbound. The front of V1 struck the right front of V2."
GRAPH = network("four_leg")


def scenario(oddity: float) -> Scenario:
    behavior = crossing()
    planned = plan(behavior, GRAPH)
    return Scenario(xosc="", actors=(), behavior=behavior, planned=planned.trajectories, oddity=oddity)


def other_side(facts: CrashFacts) -> BehaviorSpec:
    """A behavior that meets in ordinary driving for the corner's other side only."""
    if facts.contacts[0].struck_area == read(TEXT).crash.contacts[0].struck_area:
        raise InvalidOutput("this reading cannot be placed")
    return crossing()


def other_open_side(facts: CrashFacts) -> BehaviorSpec:
    """The same for sides that nobody tells."""
    if facts.contacts[0].struck_area == read(OPEN).crash.contacts[0].struck_area:
        raise InvalidOutput("this reading cannot be placed")
    return crossing()


def test_no_doubt_tries_nothing() -> None:
    facts = read(TEXT).crash
    least = least_doubted(facts, other_side, GRAPH, scenario(0.1))
    assert (least.facts, least.words, least.notes()) == (facts, "", [])


def test_a_told_corner_gives_way_only_where_nothing_comes_about() -> None:
    facts = read(TEXT).crash
    least = least_doubted(facts, other_side, GRAPH, scenario(1.5))
    assert least.facts == facts
    assert "instead of" in least.notes()[0]
    assert least.notes()[0].endswith("kept: the first reading")
    met = scenario(0.0)
    assert met.behavior is not None
    wrong = met.behavior.contacts[0].model_copy(update={"struck_area": "left"})
    unmet = met.model_copy(update={"behavior": met.behavior.model_copy(update={"contacts": (wrong,)})})
    least = least_doubted(facts, other_side, GRAPH, unmet)
    assert least.facts.contacts[0].struck_area != facts.contacts[0].struck_area


OPEN = "V1 was eastbound. V2 was southbound. V1 struck V2."


def test_the_reading_that_leaves_no_doubt_is_kept() -> None:
    facts = read(OPEN).crash
    least = least_doubted(facts, other_open_side, GRAPH, scenario(1.5))
    assert least.facts.contacts[0].struck_area != facts.contacts[0].struck_area
    assert least.notes()[0].endswith(f"{least.words}: 0.0; kept: {least.words}")


def test_the_first_reading_stands_where_no_other_can_be_placed() -> None:
    def nowhere(facts: CrashFacts) -> BehaviorSpec:
        raise InvalidOutput("no road")

    facts = read(TEXT).crash
    least = least_doubted(facts, nowhere, GRAPH, scenario(1.5))
    assert least.facts == facts
    assert least.notes() == ["doubt 1.5 on the first reading; tried no other; kept: the first reading"]


@pytest.mark.parametrize(("text", "oddity", "gives_way"), [
    ("V1 was eastbound. V2 left a driveway. The front of V1 struck the right side of V2.", 2.5, True),
    ("V1 was eastbound. V2 left a driveway. The front of V1 struck the right side of V2.", 1.5, False),
    ("V1 was eastbound. V2 drove. The front of V1 struck the right side of V2.", 2.5, False),
    ("V1 was eastbound. V2 was southbound. The front of V1 struck the right side of V2.", 2.5, False),
])  # fmt: skip
def test_a_heading_that_no_words_tell_gives_way_to_clearly_odd_driving(
    text: str, oddity: float, gives_way: bool
) -> None:
    facts = read(text).crash

    def turned_only(facts_: CrashFacts) -> BehaviorSpec:
        if facts_.vehicles[1].heading == facts.vehicles[1].heading:
            raise InvalidOutput("this reading cannot be placed")
        return crossing()

    least = least_doubted(facts, turned_only, GRAPH, scenario(oddity))
    assert (least.facts.vehicles[1].heading != facts.vehicles[1].heading) == gives_way


def test_a_contact_that_does_not_come_about_is_the_worst_doubt() -> None:
    met = scenario(0.2)
    assert met.behavior is not None
    apart = met.behavior.model_copy(update={"contacts": (
        met.behavior.contacts[0].model_copy(update={"struck_area": "left"}),)})  # fmt: skip
    assert doubt(met.behavior, met.planned, 0.2) == 0.0
    assert doubt(apart, met.planned, 0.2) > doubt(met.behavior, met.planned, 2.0) == 2.0


UNNUMBERED = "The AV was eastbound. A van was southbound. The front of the AV struck the right front corner of the van."
REAR = (
    "The AV was eastbound and stopped. A van was eastbound and overtook the AV. The right side of the van struck the "
    "left rear corner of the AV."
)


def of_other_side(text: str) -> Callable[[CrashFacts], BehaviorSpec]:
    """Places the readings of a text in which the other side of the struck vehicle touches, and no other ones."""
    first = read(text).crash.contacts[0].struck_area

    def placed(facts: CrashFacts) -> BehaviorSpec:
        if facts.contacts[0].struck_area == first:
            raise InvalidOutput("this reading cannot be placed")
        return crossing()

    return placed


def awry(by_rad: float) -> Scenario:
    """A doubted scenario whose first actor has turned by so much before the contact."""
    met = scenario(1.5)
    first = met.planned[0]
    headings = tuple(h + by_rad * i / len(first.heading_rad) for i, h in enumerate(first.heading_rad))
    return met.model_copy(update={"planned": (first.model_copy(update={"heading_rad": headings}), *met.planned[1:])})


def test_of_a_report_without_numbers_the_flank_of_a_corner_gives_way_to_its_end_in_odd_driving() -> None:
    facts = read(UNNUMBERED).crash
    assert facts.contacts[0].struck_area == "right"
    least = least_doubted(facts, of_other_side(UNNUMBERED), GRAPH, awry(0.0))
    assert least.facts.contacts[0].struck_area == "front"


def test_of_a_report_without_numbers_a_rear_end_gives_way_only_where_it_hides_what_is_told() -> None:
    facts = read(REAR).crash
    assert facts.contacts[0].struck_area == "back"
    assert least_doubted(facts, of_other_side(REAR), GRAPH, awry(0.0)).facts == facts
    least = least_doubted(facts, of_other_side(REAR), GRAPH, awry(4.0))
    assert least.facts.contacts[0].struck_area == "left"


def test_where_nothing_else_meets_somebody_who_slows_drives_on() -> None:
    text = "V1 was eastbound and slowed for a bus. V2 was southbound. The front of V1 struck the right side of V2."
    facts = read(text).crash

    def only_onward(facts: CrashFacts) -> BehaviorSpec:
        if facts.vehicles[0].maneuver == "slowing":
            raise InvalidOutput("this reading cannot be placed")
        return crossing()

    met = scenario(0.0)
    assert met.behavior is not None
    wrong = met.behavior.contacts[0].model_copy(update={"struck_area": "left"})
    unmet = met.model_copy(update={"behavior": met.behavior.model_copy(update={"contacts": (wrong,)})})
    least = least_doubted(facts, only_onward, GRAPH, unmet)
    assert least.facts.vehicles[0].maneuver == "straight"


@pytest.mark.parametrize(("other", "expected"), [("N", 10.0), ("E", 0.0)])
def test_a_near_crash_of_two_that_come_nowhere_near_is_doubted(other: str, expected: float) -> None:
    conflict = Contact(striker="V1", struck="V2", striker_area="front", struck_area="left")
    actors = (actor("V1", "straight", "S"), actor("V2", "straight", other))
    behavior = BehaviorSpec(actors=actors, near_crash=NearCrash(conflict=conflict))
    assert doubt(behavior, plan(behavior, GRAPH).trajectories, 0.0) == expected
