"""Peaks of motions whose curvature, yaw and slip are known, and depths of boxes that overlap."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.case.records import Trajectory
from sgcad_core.metrics.drivability import deepest_overlap, driving_peaks, first_touches
from sgcad_core.metrics.thresholds import DRIVING

LENGTH = 4.7


def motion(name: str, xy: np.ndarray, heading: np.ndarray) -> Trajectory:
    speed = np.gradient(np.hypot(*(xy - xy[0]).T), 0.05)
    return Trajectory(
        actor=name, t_s=0.05 * np.arange(len(xy)), x_m=xy[:, 0], y_m=xy[:, 1], heading_rad=heading, speed_mps=speed
    )


def circle(radius: float, speed: float, behind: float = 0.3 * LENGTH) -> Trajectory:
    """A box whose point `behind` its center runs around a circle and points along it."""
    angle = speed / radius * 0.05 * np.arange(120)
    axle = radius * np.column_stack((np.sin(angle), 1 - np.cos(angle)))
    return motion("V1", axle + behind * np.column_stack((np.cos(angle), np.sin(angle))), angle)


def straight(name: str, x: float, y: float, speed: float) -> Trajectory:
    t = 0.05 * np.arange(60)
    return motion(name, np.column_stack((x + speed * t, np.full(60, y))), np.zeros(60))


def test_a_circle_has_the_acceleration_and_yaw_of_a_circle_and_no_slip() -> None:
    seen = driving_peaks(circle(20.0, 10.0), LENGTH)
    assert seen.lateral_mps2 == pytest.approx(math.hypot(20.0, 0.3 * LENGTH) * 0.5**2, rel=0.01)
    assert seen.yaw_radps == pytest.approx(0.5)
    assert seen.slip_rad < 1e-6
    assert seen.excesses("dry") == ()


def test_a_box_that_turns_about_its_center_slips_at_its_rear_axle() -> None:
    seen = driving_peaks(circle(7.0, 4.0, behind=0.0), LENGTH)
    assert math.degrees(seen.slip_rad) == pytest.approx(math.degrees(math.atan(0.3 * LENGTH / 7.0)), abs=0.1)
    assert seen.excesses(None) == (f"slip angle {math.degrees(seen.slip_rad):.1f} of 10 degrees",)


@pytest.mark.parametrize(("surface", "limit"), [("dry", 8.3), ("wet", 5.9), ("snow", 2.0), ("ice", 1.0)])
def test_friction_is_that_of_the_surface(surface, limit):
    assert DRIVING.friction_mps2(surface) == pytest.approx(limit, abs=0.05)
    fast, slow = (circle(30.0, math.sqrt(30.0 * limit * k)) for k in (1.15, 0.85))
    assert any(word.startswith("lateral") for word in driving_peaks(fast, LENGTH).excesses(surface))
    assert not driving_peaks(slow, LENGTH).excesses(surface)


def test_what_happens_from_the_touch_on_does_not_count() -> None:
    calm = straight("V1", 0.0, 0.0, 10.0)
    heading = calm.heading_rad.copy()
    heading[40:] += 1.0
    spun = calm.model_copy(update={"heading_rad": heading})
    assert driving_peaks(spun, LENGTH, 40).excesses("dry") == ()
    assert len(driving_peaks(spun, LENGTH).excesses("dry")) == 2


def test_who_backs_slips_only_where_it_is_not_meant_to() -> None:
    back = straight("V1", 0.0, 0.0, -3.0)
    assert driving_peaks(back, LENGTH, backing=True).slip_rad < 1e-9
    assert driving_peaks(back, LENGTH).slip_rad == pytest.approx(math.pi)


def test_touches_and_depths_are_those_of_the_boxes() -> None:
    sizes = {"V1": (4.0, 2.0), "V2": (4.0, 2.0), "V3": (4.0, 2.0)}
    moving, standing = straight("V1", -10.0, 0.0, 2.5), straight("V2", 0.0, 0.0, 0.0)
    far = straight("V3", 0.0, 9.0, 0.0)
    assert first_touches((moving, standing, far), sizes) == {"V1": 48, "V2": 48}
    depth, pair = deepest_overlap((moving, standing, far), sizes, at_rest=True)
    assert depth == pytest.approx(4.0 - (10.0 - 2.5 * 0.05 * 59))
    assert pair == "V1 and V2"
    assert deepest_overlap((standing, far), sizes) == (0.0, "")


def test_parts_of_one_thing_do_not_overlap() -> None:
    sizes = {"V1": (4.0, 2.0), "T1": (4.0, 2.0)}
    assert deepest_overlap((straight("V1", 0.0, 0.0, 2.0), straight("T1", -3.0, 0.0, 2.0)), sizes) == (0.0, "")
