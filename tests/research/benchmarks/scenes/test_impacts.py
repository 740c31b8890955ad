"""Staged collisions: boxes are put as measured, the model gains no energy, and its error is what the pages say."""

import math

import numpy as np
import pytest
import yaml

from research.benchmarks.scenes.impacts import FILE, TOUCH_M, WALL_MODE, impact_point, main, offs, placed, table
from sgcad_core.handover.severity import exchanged
from sgcad_core.planner.aftermath.wreck_bodies import separation

PAIRS = yaml.safe_load(FILE.read_text(encoding="utf-8"))["pairs"]


def test_every_test_has_a_source_and_both_measurements():
    sources = yaml.safe_load(FILE.read_text(encoding="utf-8"))["sources"]
    assert len(PAIRS) == 16
    assert all(p["source"] in sources and all(len(row) == 2 for row in p["delta_v"]) for p in PAIRS)


def test_a_center_of_impact_is_where_its_ray_leaves_the_box():
    car = {"size": [4.0, 2.0], "center": [0.0]}
    assert impact_point(car) == pytest.approx((2.0, 0.0))
    assert impact_point(car | {"center": [90.0]}) == pytest.approx((0.0, 1.0))
    assert impact_point(car | {"center": [180.0]}) == pytest.approx((-2.0, 0.0))
    assert impact_point(car | {"center": [-45.0]}) == pytest.approx((1.0, -1.0))
    assert impact_point(car | {"ahead": 1.5, "center": [0.0]}) == pytest.approx((2.0, 0.0))
    assert impact_point(car | {"center": [30.0, 1.0]}) == pytest.approx((math.cos(math.pi / 6), 0.5))


@pytest.mark.parametrize("pair", PAIRS, ids=lambda p: p["test"])
def test_both_only_just_touch_and_come_together(pair):
    first, second = placed(pair)
    seen = separation(first, second)
    assert -TOUCH_M - 0.01 <= seen.gap_m <= -TOUCH_M
    closing = (first.vx - second.vx) * seen.normal[0] + (first.vy - second.vy) * seen.normal[1]
    assert closing > 0


@pytest.mark.parametrize("pair", PAIRS, ids=lambda p: p["test"])
@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.4])
def test_no_staged_impact_gains_energy_and_momentum_is_kept(pair, restitution):
    first, second = placed(pair)
    energy = first.energy + second.energy
    one, two = exchanged(first, second, restitution)
    assert first.energy + second.energy < energy
    masses = pair["first"]["mass"], pair["second"]["mass"]
    assert np.array(one) * masses[0] == pytest.approx(-np.array(two) * masses[1], abs=1e-6)


def test_the_model_is_as_near_as_the_pages_say():
    """Docs tell these figures (docs/results-reports.md): a change of the model changes them."""
    found = offs()
    two = np.array([o.error for o in found if o.mode != WALL_MODE])
    front = np.array([o.error for o in found if o.mode.startswith("front to front")])
    side = np.array([o.error for o in found if o.mode.startswith("front to side")])
    assert two.mean() == pytest.approx(-0.081, abs=0.005)
    assert math.sqrt((two**2).mean()) == pytest.approx(0.180, abs=0.005)
    assert abs(front.mean()) < 0.02
    assert side.mean() == pytest.approx(-0.19, abs=0.01)


def test_a_car_stopped_by_a_wall_takes_its_speed_and_the_bounce():
    walls = [o for o in offs(restitution=0.0) if o.mode == WALL_MODE]
    assert len(walls) == 9
    assert all(o.model_mps <= 18.0 for o in walls)


def test_the_table_has_a_row_a_mode(capsys):
    assert main(["--tests"]) == 0
    shown = capsys.readouterr().out
    assert "| RICSAC 9 | 1 |" in shown
    assert "| front to side 90 | 3 | 6 |" in shown
    assert table(offs()).count("\n") == 1 + len({o.mode for o in offs()}) + 1
