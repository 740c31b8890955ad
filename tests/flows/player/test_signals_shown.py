"""Signals in the player show what the plan says, and nothing where there is no plan."""

import numpy as np

from flows.player.road_shapes import drawing_of
from flows.player.signals_shown import shown_by, signals_shown
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.rules.drives import lanes, scene


def test_a_signal_changes_when_its_plan_does():
    made = scene("signal", signal={"NS": "green 2 yellow 1 red 9", "EW": "red 99"},
                 V1={"way": "S -N", "at": [[-60, 12], [40, 12]]})  # fmt: skip
    found = {s.edge: s.changes for s in shown_by(made.lights, made.trajectories[0].t_s)}
    assert found["S"] == [(0, "green"), (40, "yellow"), (60, "red")]
    assert found["E"] == [(0, "red")]


def test_without_a_plan_no_signal_is_lit():
    assert signals_shown(lanes("signal"), "<OpenSCENARIO/>", np.zeros(3)) == []


def test_no_dashed_line_runs_between_road_and_sidewalk():
    legs = [Leg(bearing=b, lanes_in=2, lanes_out=2, beside=("sidewalk",)) for b in "NS"]
    spec = road_spec(RoadLayout(legs=tuple(legs)))
    made = compile_network(plain_xml(spec), spec)
    lines = [line.style for line in drawing_of(made.net_xml).lines]
    assert lines.count("lane") == 4  # one a direction of each leg: between its two lanes for cars
    assert lines.count("edge") == 4
