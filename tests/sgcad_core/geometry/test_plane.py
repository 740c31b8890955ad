"""Boxes: the array functions say what the single-box functions say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import (
    SIDES,
    Box,
    arc_lengths,
    box_gaps,
    contact_area,
    corners,
    corners_of,
    gaps_where_near,
    local_points,
    offset_polyline,
    overlap,
    overlap_centers,
    overlap_polygon,
    resample,
    sides_at,
    wrap_angle,
)

near = st.floats(-4, 4)
angle = st.floats(-7, 7)
length, width = st.floats(0.5, 12), st.floats(0.4, 3)
box = st.builds(Box, near, near, angle, length, width)


def rows(*boxes: Box) -> np.ndarray:
    return np.array([b[:3] for b in boxes])


def in_general_position(first: Box, second: Box) -> bool:
    """No side parallel to another: on coinciding sides the clipped polygon repeats corners."""
    return abs(math.sin(2 * (first.heading_rad - second.heading_rad))) > 0.02


def size(b: Box) -> tuple[float, float]:
    return b.length_m, b.width_m


@settings(max_examples=150, deadline=None)
@given(box, box)
def test_shared_center_is_that_of_the_clipped_polygon(first, second):
    assume(in_general_position(first, second))
    gap = box_gaps(rows(first), size(first), rows(second), size(second))[0]
    center = overlap_centers(rows(first), size(first), rows(second), size(second))[0]
    if gap > 1e-6:
        assert np.isnan(center).all()
    elif gap < -0.01:
        assert center == pytest.approx(overlap_polygon(second, first).mean(axis=0), abs=0.02)


@settings(max_examples=150, deadline=None)
@given(box, box)
def test_side_codes_name_the_contact_area(first, second):
    gap = box_gaps(rows(first), size(first), rows(second), size(second))[0]
    assume(in_general_position(first, second) and gap < -0.01)
    side, clearness = sides_at(
        rows(first), size(first), overlap_centers(rows(first), size(first), rows(second), size(second))
    )
    if clearness[0] > 0.05:
        assert SIDES[side[0]] == contact_area(first, second)


@settings(max_examples=200, deadline=None)
@given(box, box)
def test_gap_is_symmetric_and_agrees_with_overlap(first, second):
    ab = box_gaps(rows(first), size(first), rows(second), size(second))[0]
    ba = box_gaps(rows(second), size(second), rows(first), size(first))[0]
    assert ab == pytest.approx(ba, abs=1e-9)
    assert overlap(first, second) == (ab <= 0)


@given(box)
def test_corners_lie_on_the_box(b):
    assert corners_of(rows(b), size(b))[0] == pytest.approx(corners(b), abs=1e-9)
    local = local_points(rows(b), corners(b)[None])[0]
    assert np.abs(local) == pytest.approx(np.tile([b.length_m / 2, b.width_m / 2], (4, 1)), abs=1e-6)


def test_sides_of_a_car_struck_all_around():
    car = Box(0, 0, math.pi / 2, 4.7, 1.8)
    others = {"front": (0, 2.5), "back": (0, -2.5), "left": (-1.0, 0), "right": (1.0, 0)}
    for side, (x, y) in others.items():
        assert contact_area(car, Box(x, y, 0.3, 0.6, 0.6)) == side


@given(angle)
def test_wrapped_angle_is_the_same_direction(a):
    wrapped = float(wrap_angle(a))
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(a), abs=1e-9)


def test_an_offset_line_runs_beside_at_its_distance():
    line = np.column_stack((np.linspace(0, 30, 31), np.zeros(31)))
    assert offset_polyline(line, 2.0)[:, 1] == pytest.approx(np.full(31, 2.0))
    assert arc_lengths(line)[-1] == pytest.approx(30)
    assert resample(line, [-1.0, 12.5, 99.0])[:, 0] == pytest.approx([0, 12.5, 30])


@settings(max_examples=150, deadline=None)
@given(box, box)
def test_gaps_are_those_of_the_corners_on_the_four_axes(first, second):
    gaps = []
    for axis in (a + turn for a in (first.heading_rad, second.heading_rad) for turn in (0.0, math.pi / 2)):
        one, two = (corners(b) @ np.array([math.cos(axis), math.sin(axis)]) for b in (first, second))
        gaps.append(max(one.min() - two.max(), two.min() - one.max()))
    found = box_gaps(rows(first), size(first), rows(second), size(second))[0]
    assert found == pytest.approx(max(gaps), abs=1e-9)


@settings(max_examples=150, deadline=None)
@given(first=box, second=box, away=st.floats(0, 6), margin=st.floats(0, 2))
def test_only_gaps_wider_than_asked_are_left_unmeasured(first: Box, second: Box, away: float, margin: float) -> None:
    ours = rows(first, first)
    theirs = rows(second, second._replace(x_m=second.x_m + away * 3, y_m=second.y_m - away))
    sizes = first[3:], second[3:]
    gaps, near = box_gaps(ours, sizes[0], theirs, sizes[1]), gaps_where_near(ours, sizes[0], theirs, sizes[1], margin)
    measured = np.isfinite(near)
    assert np.array_equal(near[measured], gaps[measured])
    assert (gaps[~measured] > margin).all()
    far = rows(second, second._replace(x_m=1000.0))[[1, 1]]
    assert np.isinf(gaps_where_near(ours, sizes[0], far, sizes[1], margin)).all()
