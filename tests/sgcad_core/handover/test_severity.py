"""Delta-v, energy and risk of a contact, against closed cases."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.handover.contact_figures import impact_summary
from sgcad_core.handover.severity import fatality_risk, severity
from sgcad_core.planner.aftermath.impact import RESTITUTION, body, collide
from tests.sgcad_core.handover.scenes import crossing, rear_end


def of(made):
    return severity(made.contact_of("V1"), made.trajectories, {a.id: a for a in made.actors})


def test_two_equal_cars_in_line_share_the_closing_speed():
    found = of(rear_end(own=20.0, other=8.0))
    each = (1 + RESTITUTION) / 2 * 12.0
    assert found.closing_mps == pytest.approx(12.0, abs=1e-6)
    assert found.of("V1").delta_v_mps == pytest.approx(each, rel=1e-6)
    assert found.of("V1").delta_v_ahead_mps == pytest.approx(-each, rel=1e-6)
    assert found.of("V2").delta_v_ahead_mps == pytest.approx(each, rel=1e-6)
    assert found.energy_j == pytest.approx(1450 / 4 * 12**2 * (1 - RESTITUTION**2), rel=1e-6)


def test_the_lighter_one_takes_more():
    found = of(rear_end(own=20.0, kinds={"V2": "truck"}))
    assert found.of("V1").delta_v_mps > 4 * found.of("V2").delta_v_mps


def test_an_object_stays_where_it_is_and_has_no_risk():
    found = of(rear_end(own=10.0, kinds={"V2": "object"}))
    assert found.of("V2").risk is None
    assert found.of("V1").delta_v_mps == pytest.approx((1 + RESTITUTION) * 10, rel=1e-6)


def test_closing_speed_of_crossing_cars_is_that_of_their_relative_motion():
    assert of(crossing(own=6.0, other=8.0)).closing_mps == pytest.approx(10.0, rel=1e-6)


@settings(max_examples=300, deadline=None)
@given(
    pose=st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(-3.1, 3.1)),
    speeds=st.lists(st.floats(-40, 40), min_size=6, max_size=6),
    masses=st.tuples(st.floats(70, 4e4), st.floats(70, 4e4)),
    at=st.tuples(st.floats(-3, 3), st.floats(-3, 3)), normal=st.floats(-3.2, 3.2), restitution=st.floats(0, 1),
)  # fmt: skip
def test_an_impact_never_gives_energy_and_keeps_momentum(pose, speeds, masses, at, normal, restitution):
    a, b = body((0.0, 0.0, 0.0), (4.7, 1.8), masses[0]), body(pose, (5.6, 2.0), masses[1])
    a.vx, a.vy, a.spin, b.vx, b.vy, b.spin = speeds
    before = a.energy + b.energy
    momentum = masses[0] * a.vx + masses[1] * b.vx, masses[0] * a.vy + masses[1] * b.vy
    collide(a, b, at, (math.cos(normal), math.sin(normal)), restitution)
    assert a.energy + b.energy <= before * (1 + 1e-9) + 1e-6
    after = masses[0] * a.vx + masses[1] * b.vx, masses[0] * a.vy + masses[1] * b.vy
    assert after == pytest.approx(momentum, rel=1e-6, abs=1e-3 * sum(masses))


def test_risks_are_the_published_ones():
    """Joksch: certain at 71 mph, a sixteenth at half of it; Rosen and Sander: 8 % at 50 km/h."""
    assert fatality_risk("car", 71 * 0.44704, 0.0) == pytest.approx(1.0)
    assert fatality_risk("car", 35.5 * 0.44704, 0.0) == pytest.approx(1 / 16)
    assert fatality_risk("pedestrian", 0.0, 50 / 3.6) == pytest.approx(0.083, abs=0.002)
    assert fatality_risk("car", 60.0, 0.0) == 1.0


def test_rest_is_the_last_pose_with_way_and_turn_since_the_contact():
    made = rear_end(own=20.0)
    struck = made.trajectories[1]
    k, n = round(6.0 / 0.05), len(struck.t_s)
    pushed = np.clip(np.arange(n) - k, 0, 20)  # from the contact on, a second long, 0.2 m and 0.01 rad a sample
    moved = struck.model_copy(
        update={"x_m": struck.x_m + 0.2 * pushed, "heading_rad": struck.heading_rad + 0.01 * pushed}
    )
    told = impact_summary(replace(made, trajectories=(made.trajectories[0], moved)), made.contact_of("V1"))
    one, two = told["actors"]
    assert (one["id"], two["id"]) == ("V1", "V2")
    assert two["rest"] == {
        "x_m": 4.0, "y_m": 0.0, "heading_rad": 0.2, "from_s": 7.0, "went_m": 4.0, "turned_rad": 0.2
    }  # fmt: skip
    assert told["closing_mps"] == pytest.approx(20.0, abs=1e-3)


def test_the_change_of_velocity_of_a_script_is_that_of_its_motion():
    made = rear_end(own=20.0)
    rams, stands = made.trajectories
    gone = np.clip(np.arange(len(rams.t_s)) - round(6.0 / 0.05), 0, None) * 0.05
    onward = (rams.model_copy(update={"x_m": rams.x_m + 14.0 * gone}),
              stands.model_copy(update={"x_m": stands.x_m + 3.0 * gone}))  # fmt: skip
    told = impact_summary(replace(made, trajectories=onward), made.contact_of("V1"))
    one, two = told["actors"]
    assert (one["delta_v_mps"], one["ahead_mps"]) == pytest.approx((6.0, -6.0), abs=1e-3)
    assert (two["delta_v_mps"], two["ahead_mps"]) == pytest.approx((3.0, 3.0), abs=1e-3)
    mass = 2 * of(made).energy_j / (20.0**2 * (1 - RESTITUTION**2) / 2)  # of equal cars
    assert told["energy_j"] == pytest.approx(mass / 2 * (20.0**2 - 14.0**2 - 3.0**2), rel=1e-4)


def test_who_still_moves_at_the_end_has_no_rest_and_without_a_contact_nothing_is_told():
    made = rear_end(own=20.0)
    last = made.trajectories[1]
    rolling = last.model_copy(update={"x_m": last.x_m + 0.1 * np.clip(np.arange(len(last.t_s)) - 120, 0, None)})
    told = impact_summary(replace(made, trajectories=(made.trajectories[0], rolling)), made.contact_of("V1"))
    assert told["actors"][1]["rest"]["from_s"] is None
    assert impact_summary(made, None) is None
