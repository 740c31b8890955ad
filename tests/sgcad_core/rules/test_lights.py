"""What signals show at any time: phases repeat, and a state lasts since it began."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.errors import InvalidOutput
from sgcad_core.rules.lights import Turn, lights_of
from tests.sgcad_core.rules.drives import lanes

PHASES = st.lists(st.tuples(st.floats(0.5, 30.0), st.sampled_from(["red", "yellow", "green"])), min_size=1, max_size=6)


@given(PHASES, st.floats(0.0, 200.0))
def test_phases_repeat_and_a_state_has_lasted_at_most_a_cycle(phases: list[tuple[float, str]], t_s: float) -> None:
    turn, cycle = Turn(tuple(phases)), sum(s for s, _ in phases)
    shown = turn.at(t_s)
    assert shown is not None
    assert shown.state in {state for _, state in phases}
    assert 0 <= shown.since_s <= cycle
    just = turn.at(max(t_s - min(shown.since_s, t_s) / 2, 0.0))
    assert just is not None
    assert just.state == shown.state


def test_a_state_that_goes_on_over_phases_is_one() -> None:
    shown = Turn(((2.0, "red"), (3.0, "green"), (5.0, "red"))).at(11.0)
    assert shown is not None
    assert (shown.state, shown.since_s) == ("red", 6.0)


def test_a_file_without_a_plan_tells_nothing() -> None:
    assert lights_of(lanes("signal"), "<OpenSCENARIO/>") is None
    assert lights_of(lanes("road"), "<OpenSCENARIO/>") is None
    with pytest.raises(InvalidOutput, match=r"scenario\.xosc"):
        lights_of(lanes("signal"), "no xml")


def test_a_controller_of_the_file_holds_for_its_connections() -> None:
    graph = lanes("signal")
    file = (
        "<OpenSCENARIO><RoadNetwork><TrafficSignals><TrafficSignalController name='1'><Phase name='a' duration='9'>"
        "<TrafficSignalState trafficSignalId='1' state='red'/></Phase></TrafficSignalController></TrafficSignals>"
        "</RoadNetwork></OpenSCENARIO>"
    )
    lights = lights_of(graph, file)
    assert lights is not None
    shown = [lights.at(link, 3.0) for link in graph.connections if link.light]
    assert {s.state for s in shown if s} == {"red"}
    assert any(s is None for s in shown)
