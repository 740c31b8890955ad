"""Run-outs that lead a struck vehicle into another one, or off the road."""

from __future__ import annotations

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.later.later_courses import run_outs, runs_into, runs_on, runs_to_line, with_run
from sgcad_core.planner.scene import Scene
from sgcad_core.records.specs import Actor
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.planner.crash_scenes import network

_CONTACT = 40


def scene(*standing: tuple[float, float, float]) -> Scene:
    """V1 comes northwards at 15 m/s along x = 1.6 and strikes V2, which stands askew before it; others stand about."""
    made = Scene(220, _CONTACT)
    for number, pose in enumerate([(1.6, -40.0, np.pi / 2), (2.6, 0.0, np.pi / 2), *standing], 1):
        actor = Actor(id=f"V{number}", kind="car", road="S", direction="forward", maneuver="stopped")
        made.tracks[actor.id] = standing_track(made, actor, np.array(pose))
    driven: Floats = np.repeat(made.tracks["V1"].driven, 1, axis=0)
    driven[:, 1] = -35.0 + 0.75 * np.arange(made.count)
    made.tracks["V1"].driven = driven
    made.settle()
    return made


def touching(made: Scene) -> set[frozenset[str]]:
    return {frozenset((touch.first, touch.second)) for touch in made.touches}


def test_a_run_out_leads_a_struck_vehicle_into_another_one() -> None:
    made = scene((-4.0, 14.0, np.pi / 2))
    assert frozenset(("V1", "V3")) not in touching(made)
    for run in list(runs_into(made, "V1", "V3", _CONTACT))[:6]:
        made.runs = with_run(made, "V1", run)
        made.settle()
        if frozenset(("V1", "V3")) in touching(made):
            return
    raise AssertionError("no run-out leads there")


def test_a_run_out_leads_a_struck_vehicle_onto_a_line_while_it_moves() -> None:
    made = scene()
    beside = np.column_stack((np.full(40, -3.0), np.linspace(0.0, 40.0, 40)))
    runs = list(runs_to_line(made, "V1", beside, _CONTACT))
    assert runs
    made.runs = with_run(made, "V1", runs[0])
    made.settle()
    poses = made.tracks["V1"].poses[_CONTACT:]
    mps = np.hypot(*np.diff(poses[:, :2], axis=0).T) / 0.05
    near = np.abs(poses[1:, 0] + 3.0) < 1.5
    assert (near & (mps > 2.0)).any()
    assert list(runs_to_line(made, "V1", beside + np.array([60.0, 0.0]), _CONTACT)) == []
    assert list(runs_to_line(made, "V1", np.zeros((0, 2)), _CONTACT)) == []


def test_what_was_never_struck_has_no_run_out() -> None:
    made = scene((30.0, 14.0, np.pi / 2))
    assert list(runs_into(made, "V3", "V1", _CONTACT)) == []


def test_run_outs_that_leave_the_road_come_first() -> None:
    made, surface = scene(), road_surface(network("straight"))
    found = run_outs(made, "V1", _CONTACT)
    assert found is not None
    off = surface.off(found.ways[-1][:, :2])[0]
    first = next(runs_on(made, "V1", surface, _CONTACT))
    assert off.min() < 0.0 < off[found.runs.index(first)]


def test_a_further_run_out_counts_from_its_time_on_and_keeps_the_earlier_one() -> None:
    made = scene()
    early = next(runs_on(made, "V1", road_surface(network("straight")), _CONTACT))
    made.runs = with_run(made, "V1", early)
    later = early._replace(from_s=early.from_s + 1.0, bend_per_m=0.06)
    assert with_run(made, "V1", later)["V1"] == (early, later)
    assert with_run(made, "V1", later._replace(from_s=early.from_s))["V1"] == (later._replace(from_s=early.from_s),)
