"""The other drivers: AEB, IDM, replay, the combination, the script."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from plugins.driver.aeb import Aeb
from plugins.driver.combined import Combined
from plugins.driver.idm import Idm
from plugins.driver.reference import Reference
from plugins.driver.replay import Replay
from plugins.driver.script import Script
from sgcad_core.errors import ConfigError, SimulationFailed
from sgcad_core.handover.drive import drive
from sgcad_core.handover.script import staging_for
from tests.plugins.driver.seats import ride, task, user, view
from tests.sgcad_core.handover.scenes import crossing, rear_end


def test_aeb_brakes_at_its_threshold_after_its_delay():
    made = task(20.0, friction=9.0)
    rows = ride(Aeb(ttc_s=1.5, delay_s=0.3, deceleration_mps2=7.0).take_over(made), made, lambda t: [user(x=104.7)])
    onset = rows[rows[:, 3] < -1][0, 0]
    assert onset == pytest.approx(5.0 - 1.5 + 0.3, abs=0.11)
    assert rows[:, 3].min() == pytest.approx(-7.0)


def test_aeb_sees_only_what_lies_in_its_cone():
    """A car from the side, on a course to meet: with a narrow cone nobody is there."""

    def crossing_car(t):
        return [user(x=60.0, y=-30.0 + 10.0 * t, speed=10.0, course=math.pi / 2)]

    made = task(20.0)
    wide = ride(Aeb(half_view_deg=60).take_over(made), made, crossing_car, 3.0)
    narrow = ride(Aeb(half_view_deg=5).take_over(made), made, crossing_car, 2.6)
    assert wide[:, 3].min() < -1
    assert narrow[:, 3].min() > -0.01


def test_idm_settles_at_the_gap_of_its_formula():
    """Behind a steady leader s = (s0 + v T) / sqrt(1 - (v / v0)^4)."""
    made = task(20.0)
    rows = ride(
        Idm(headway_s=1.2, gap_m=2.0).take_over(made), made, lambda t: [user(x=80.0 + 12 * t, speed=12.0)], 38.0
    )
    gap = 80.0 + 12 * rows[-1, 0] - rows[-1, 1] - 4.7
    assert rows[-1, 2] == pytest.approx(12.0, abs=0.1)
    assert gap == pytest.approx((2 + 12 * 1.2) / math.sqrt(1 - (12 / 20) ** 4), rel=0.05)


def test_idm_gives_way_at_its_line_and_goes_when_the_road_is_free():
    made = task(10.0, gives_way=50.0)

    def passing(t):
        return [user(x=60.0, y=60.0 - 10.0 * t, speed=10.0, course=-math.pi / 2)]

    rows = ride(Idm().take_over(made), made, passing, 20.0)
    waiting = rows[(rows[:, 0] > 5.5) & (rows[:, 0] < 6.0)]
    assert waiting[:, 1].max() < 51
    assert rows[-1, 1] > 70
    assert (np.hypot(60.0 - rows[:, 1], 60.0 - 10.0 * rows[:, 0]) > 3.0).all()


def test_who_has_the_right_of_way_does_not_stop_for_one_who_waits():
    made = task(10.0)
    rows = ride(Idm().take_over(made), made, lambda t: [user(x=60.0, y=6.0, course=-math.pi / 2)], 5.0)
    assert rows[:, 2].min() > 9.5


def test_the_combination_brakes_as_hard_as_the_hardest():
    made = task(20.0, friction=9.0)
    both = Combined(of=["reference", {"name": "aeb", "ttc_s": 2.5}])
    alone = ride(Reference().take_over(made), made, lambda t: [user(x=104.7)])
    together = ride(both.take_over(made), made, lambda t: [user(x=104.7)])
    assert (together[:, 2] <= alone[:, 2] + 1e-9).all()
    assert together[-1, 1] < alone[-1, 1]


def test_a_combination_names_what_is_wrong_in_it():
    with pytest.raises(ValidationError, match="unknown driver 'nobody'"):
        Combined(of=["reference", "nobody"])
    with pytest.raises(ValidationError, match="at least 2"):
        Combined(of=["reference"])
    with pytest.raises(ValidationError, match="expected drivers with a name"):
        Combined(of=[{"ttc_s": 1.0}, "aeb"])


def replayed(tmp_path, x, y=0.0):
    """V1 on places 0.05 s apart; it begins at -63.23 m with 10 m/s."""
    places = np.broadcast_arrays(x, y)
    lines = [f"{k / 20:.2f},V1,{east:.4f},{north:.4f},0.0" for k, (east, north) in enumerate(zip(*places, strict=True))]
    (tmp_path / "made.csv").write_text("t_s,actor,x_m,y_m,heading_rad\n" + "\n".join(lines) + "\n0.0,V2,1,1,1\n")
    return drive(staging_for(crossing(), "V1"), Replay(file=tmp_path / "{case}.csv"))


def test_a_given_trajectory_is_driven_whatever_happens(tmp_path):
    t = np.arange(200) / 20
    braking = -63.23 + np.where(t < 10 / 3, 10 * t - 1.5 * t**2, 100 / 6)
    driven = replayed(tmp_path, braking)
    assert driven.ego.x_m[40] == pytest.approx(-63.23 + 20 - 6, abs=1e-3)
    assert driven.ego.speed_mps[40] == pytest.approx(4.0, abs=0.01)
    assert driven.contact is None


def test_a_given_trajectory_that_jumps_is_no_crash_avoided(tmp_path):
    t = np.arange(200) / 20
    for x, y in [(-63.23 + 10 * t + 30 * (t > 2), 0.0), (-63.23 + 10 * t, 4.0 * (t > 2)), (-63.23 + 0 * t, 0.0)]:
        with pytest.raises(SimulationFailed, match="the driver of V1 asks for impossible motion"):
            replayed(tmp_path, x, y)


HEAD = "t_s,x_m,y_m,heading_rad\n"


@pytest.mark.parametrize("content", ["", "t_s,x_m\n1,2\n", f"{HEAD}0,0,0,0\n", f"{HEAD}1,0,0,0\n0,0,0,0\n"])
def test_a_file_that_is_no_trajectory_is_refused(tmp_path, content):
    file = tmp_path / "bad.csv"
    file.write_text(content)
    with pytest.raises(ConfigError, match=r"driver replay: .*bad\.csv"):
        Replay(file=file).take_over(task())


def test_the_script_goes_on_at_the_factor_with_which_it_began():
    made = task(20.0)
    assert Script().take_over(made).act(view(made, speed=16.0)).acceleration_mps2 == pytest.approx(0.0, abs=1e-9)


def test_aeb_makes_a_rear_end_softer_or_avoids_it():
    driven = drive(staging_for(rear_end(own=15.0), "V1"), Aeb(ttc_s=1.8))
    assert driven.contact is None or driven.ego.speed_mps[-1] < 8
