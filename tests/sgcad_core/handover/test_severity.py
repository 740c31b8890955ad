"""Delta-v, energy and risk of a contact, against closed cases."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.handover.severity import fatality_risk, severity
from sgcad_core.planner.impact import RESTITUTION, body, collide
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
