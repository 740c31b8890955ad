"""Distances and times agree with brute force, with analysis and with themselves seen from elsewhere."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import Box, corners, overlap
from sgcad_core.metrics import conflict
from sgcad_core.metrics.swept_cells import Track

COORDINATE = st.floats(-30, 30)
SPEED = st.floats(-20, 20)
ANGLE = st.floats(-math.pi, math.pi)
SIZE = st.tuples(st.floats(0.5, 12), st.floats(0.5, 3))


def straight(x, y, heading, vx, vy, size, seconds=0.0, dt=0.05) -> Track:
    t = np.arange(round(seconds / dt) + 1) * dt
    pose = np.column_stack((x + vx * t, y + vy * t, np.full_like(t, heading)))
    return Track(t, pose, np.tile([vx, vy], (len(t), 1)), size)


def drive(x, y, heading, speed, size=(4.5, 1.8), seconds=8.0) -> Track:
    return straight(x, y, heading, speed * math.cos(heading), speed * math.sin(heading), size, seconds)


tracks = st.builds(straight, COORDINATE, COORDINATE, ANGLE, SPEED, SPEED, SIZE)


@settings(max_examples=150, deadline=None)
@given(tracks, tracks)
def test_time_to_collision_is_when_the_boxes_first_touch(a, b):
    ttc = float(conflict.time_to_collision(a, b)[0])

    def touching(t, within_m=0.0):
        boxes = [
            Box(*(k.pose[0, :2] + t * k.velocity[0]), k.pose[0, 2], k.size[0] + within_m, k.size[1] + within_m)
            for k in (a, b)
        ]
        return overlap(*boxes)

    if math.isinf(ttc):
        assert not any(touching(t) for t in np.arange(0, 10, 0.02))
    else:
        assert touching(ttc, within_m=1e-4)  # boxes may touch in one instant only: corner on corner, or just leaving
        assert not any(touching(t) for t in np.linspace(0, max(ttc - 1e-3, 0), 200) if t < ttc - 1e-6)


@pytest.mark.parametrize(("gap_m", "own", "other"), [(20.0, 15.0, 5.0), (8.0, 10.0, 0.0), (30.0, 20.0, -10.0)])
def test_required_deceleration_is_closing_speed_squared_over_twice_the_gap(gap_m, own, other):
    first = drive(0, 0, 0, own)
    second = straight(gap_m + 4.5, 0, 0, other, 0, (4.5, 1.8), 8.0)
    needed = float(conflict.required_deceleration(first, second)[0])
    assert needed == pytest.approx((own - other) ** 2 / (2 * gap_m))


def test_off_a_collision_course_no_deceleration_is_required():
    assert not conflict.required_deceleration(drive(0, 0, 0, 10), drive(20, 5, 0, 5)).any()
    assert np.isinf(conflict.required_deceleration(drive(0, 0, 0, 10), drive(1, 0, 0, 5))[0])


@settings(max_examples=100, deadline=None)
@given(tracks, tracks)
def test_every_measure_is_the_same_from_both_sides(a, b):
    for measure in (conflict.box_distance, conflict.time_to_collision, conflict.center_distance):
        np.testing.assert_allclose(measure(a, b), measure(b, a), rtol=1e-6, atol=1e-6)


@settings(max_examples=100, deadline=None)
@given(tracks, tracks)
def test_box_distance_is_zero_exactly_on_overlap_and_never_beats_sampled_outlines(a, b):
    distance = float(conflict.box_distance(a, b)[0])
    assert (distance == 0) == bool(conflict.overlaps(a, b)[0]) or distance < 1e-9
    outline = []
    for k in (a, b):
        edge = corners(Box(*k.pose[0], *k.size))
        outline.append(np.concatenate([np.linspace(p, q, 60) for p, q in zip(edge, np.roll(edge, -1, 0), strict=True)]))
    sampled = np.hypot(*(outline[0][:, None] - outline[1][None]).transpose(2, 0, 1)).min()
    if not conflict.overlaps(a, b)[0]:
        assert distance <= sampled + 1e-9
        assert distance >= sampled - 0.25


def test_oncoming_cars_in_their_lanes_are_on_no_collision_course():
    a, b = drive(-50, -1.8, 0.0, 15), drive(50, 1.8, math.pi, 15)
    assert np.isinf(conflict.time_to_collision(a, b)).all()
    assert conflict.time_to_collision_paper(a, b).min() == pytest.approx(3.6 / 30, rel=0.05)


def test_closing_on_a_standing_car_takes_gap_over_speed():
    a, b = drive(0, 0, 0.0, 10, seconds=0), drive(54.5, 0, 0.0, 0, seconds=0)
    assert conflict.time_to_collision(a, b)[0] == pytest.approx(5.0)


def test_post_encroachment_time_of_crossing_cars_is_the_gap_between_them():
    """A clears the crossing square (half width 0.9 m + half length 2.25 m past it) before B arrives."""
    a, b = drive(-30, 0, 0.0, 10), drive(0, -50, math.pi / 2, 10)
    a_leaves = (30 + 0.9 + 2.25) / 10
    b_enters = (50 - 0.9 - 2.25) / 10
    seen = conflict.post_encroachment_time(a, b)
    assert seen.reason == "measured"
    assert seen.seconds == pytest.approx(b_enters - a_leaves, abs=0.4)
    assert seen.seconds >= b_enters - a_leaves - 0.1
    literal = conflict.post_encroachment_time_paper(a, b)
    assert literal.seconds == pytest.approx(b_enters - a_leaves, abs=0.15)


def test_post_encroachment_time_is_zero_on_overlap_and_none_apart():
    a = drive(-30, 0, 0.0, 10)
    assert conflict.post_encroachment_time(a, drive(0, -30, math.pi / 2, 10)) == (0.0, "overlap")
    assert conflict.post_encroachment_time(a, drive(-30, 40, 0.0, 10)) == (None, "no common area")
    assert conflict.post_encroachment_time(a, drive(-500, 400, 0.0, 10)) == (None, "no common area")


def test_a_paper_encroachment_that_only_the_clock_ends_is_none():
    """Whoever comes to rest in the common area never leaves it, and whoever stands there never came."""
    a, b = drive(-30, 0, 0.0, 10), drive(0, -50, math.pi / 2, 10)
    k = 60  # a stands at the crossing from 3 s on
    stopped = a._replace(pose=np.vstack((a.pose[:k], np.repeat(a.pose[k : k + 1], len(a.pose) - k, axis=0))))
    assert conflict.post_encroachment_time_paper(stopped, b) == (None, "ego never leaves")
    waiting = drive(0, 0, math.pi / 2, 0)
    assert conflict.post_encroachment_time_paper(a, waiting) == (None, "other there from the start")
