"""What a signal is told to show, held against the plan of the scenario's file."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.told_places import parking_items, signal_items
from sgcad_core.case.records import Execution, Trajectory, sizes_of
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.reading.reading import read
from sgcad_core.records.course import CourseTold
from tests.sgcad_core.execution.test_signals import CRASH
from tests.sgcad_core.formats.road_samples import compiled

TOLD = "V1 was northbound and V2 was eastbound. {0} The front of V1 struck the right side of V2."


def items(text: str, shown: dict[str, str], control: str = "signal", turned: tuple[str, ...] = ()) -> list[tuple]:
    """The items of a text, with a scenario whose signals show something."""
    courses = {who: CourseTold(signal_turned=True) for who in turned}
    scenario = compile_scenario(CRASH, compiled(control), signals=shown, courses=courses)
    contact = first_contact(scenario.planned, sizes_of(scenario.actors))
    execution = Execution(simulator="none", trajectories=scenario.planned, contact=contact)
    made = ExecutedCase(read(TOLD.format(text)), compiled(control), scenario, execution)
    return [(item.kind, item.field, item.seen) for item in signal_items(made)]


def test_a_signal_that_shows_what_is_told_is_there_and_another_state_lacks() -> None:
    assert items("V1 ran the red light.", {"V1": "red"}) == [("has", "vehicles.V1.signal", None)]
    assert items("V1 ran the red light.", {"V1": "green"}) == [("lacks", "vehicles.V1.signal", "green")]


def test_a_told_state_lacks_where_nothing_is_shown_or_no_signal_stands() -> None:
    assert items("V1 ran the red light.", {}) == [("lacks", "vehicles.V1.signal", None)]
    assert items("V1 ran the red light.", {"V1": "red"}, "all_way_stop") == [("lacks", "vehicles.V1.signal", None)]


@pytest.mark.parametrize(("turned", "kind"), [(("V1",), "has"), ((), "lacks")])
def test_a_signal_that_turned_must_not_have_shown_its_state_for_long(turned, kind) -> None:
    found = items("V1 entered when the light turned green.", {"V1": "green"}, turned=turned)
    assert [(what, field) for what, field, _ in found] == [
        ("has", "vehicles.V1.signal"), (kind, "vehicles.V1.signal_turned"),
    ]  # fmt: skip


@pytest.mark.parametrize(("aside_m", "kind"), [(0.0, "lacks"), (4.0, "has")])
def test_one_that_leaves_a_parking_place_starts_beside_the_lanes(aside_m: float, kind: str) -> None:
    scenario = compile_scenario(CRASH, compiled("signal"))
    made = ExecutedCase(
        read("V1 was northbound and V2 pulled out of a parking space. The front of V1 struck the left side of V2."),
        compiled("signal"), scenario,
        Execution(simulator="none", trajectories=tuple(_aside(t, aside_m) for t in scenario.planned), contact=None),
    )  # fmt: skip
    assert [(item.kind, item.subject) for item in parking_items(made)] == [(kind, "V2")]


def _aside(track: Trajectory, by_m: float) -> Trajectory:
    """A motion that much farther to the right of its heading."""
    right = track.heading_rad - np.pi / 2
    there = {"x_m": track.x_m + by_m * np.cos(right), "y_m": track.y_m + by_m * np.sin(right)}
    return track.model_copy(update=there)
