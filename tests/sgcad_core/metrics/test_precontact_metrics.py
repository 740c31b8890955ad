"""Metrics before the contact, against closed cases and a brute-force sweep of a millisecond."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import Box, overlap
from sgcad_core.metrics.precontact_metrics import precontact_figures
from sgcad_core.metrics.swept_cells import Track

SIZE = (4.7, 1.8)


def driven(x, y, heading, speeds, end=6.0):
    """A track that is at (x, y) at the end; `speeds` of each step, or one for all."""
    t = np.arange(0.0, end + 0.051, 0.05)
    speed = np.broadcast_to(np.asarray(speeds, dtype=float), (len(t),))
    way = np.concatenate(([0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * 0.05)))
    k = round(end / 0.05)
    along = way - way[k]
    pose = np.column_stack((x + along * math.cos(heading), y + along * math.sin(heading), np.full(len(t), heading)))
    velocity = np.column_stack((speed * math.cos(heading), speed * math.sin(heading)))
    return Track(t, pose, velocity, SIZE)


def rear_end(own=20.0, other=8.0):
    return {"V1": driven(-4.7 + 0.001, 0, 0, own), "V2": driven(0, 0, 0, other)}


def test_in_line_ttc_and_drac_are_the_published_formulas():
    found = precontact_figures(rear_end())
    for name, before in (("0_5", 0.5), ("1", 1.0), ("2", 2.0)):
        gap = 12.0 * before
        assert found[f"ttc_{name}_s_before_s"] == pytest.approx(gap / 12, abs=1e-3)
        assert found[f"drac_{name}_s_before_mps2"] == pytest.approx(12**2 / (2 * gap), rel=1e-3)


def test_exposure_is_the_time_below_the_threshold_and_its_integral():
    found = precontact_figures(rear_end())
    assert found["time_exposed_ttc_s"] == pytest.approx(1.5, abs=0.051)
    assert found["time_integrated_ttc_s2"] == pytest.approx(1.5**2 / 2, abs=0.05)
    assert found["time_exposed_drac_s"] == pytest.approx(12 / (2 * 3.35), abs=0.051)


def test_the_onset_of_braking_is_told_with_its_ttc():
    t = np.arange(0.0, 6.051, 0.05)
    speed = np.where(t < 5.0, 20.0, 20.0 - 5.0 * (t - 5.0))
    found = precontact_figures({"V1": driven(-4.699, 0, 0, speed), "V2": driven(0, 0, 0, 0.0)})
    assert found["braking_s_before_s"] == pytest.approx(1.0, abs=0.11)
    assert found["ttc_at_braking_s"] == pytest.approx((20 - 2.5) / 20, abs=0.06)
    assert precontact_figures(rear_end())["braking_s_before_s"] is None


def test_two_that_never_touch_have_no_figures():
    assert precontact_figures({"V1": driven(0, 0, 0, 10.0), "V2": driven(0, 9, 0, 10.0)}) == {}


def test_a_clock_that_begins_too_late_leaves_the_value_out():
    short = {name: Track(*(v[-35:] for v in track[:3]), track.size) for name, track in rear_end().items()}
    assert precontact_figures(short)["ttc_2_s_before_s"] is None
    assert precontact_figures(short)["ttc_1_s_before_s"] is not None


@settings(max_examples=25, deadline=None)
@given(
    own=st.floats(5, 30), other=st.floats(3, 30), angle=st.floats(0.5, 2.6), aside=st.floats(-1.5, 1.5),
    turn=st.floats(-3, 3), dx=st.floats(-500, 500), shift=st.floats(0, 50), swap=st.booleans(),
)  # fmt: skip
def test_ttc_is_what_a_sweep_finds_however_the_world_is_turned_moved_and_numbered(
    own, other, angle, aside, turn, dx, shift, swap
):
    tracks = {"V1": driven(-1.0, aside, 0, own), "V2": driven(1.0, 0, angle, other)}
    found = precontact_figures(tracks)
    if not found:
        return
    moved = {name: moved_track(t, turn, dx, shift) for name, t in tracks.items()}
    named = {"V2": moved["V1"], "V1": moved["V2"]} if swap else moved
    assert precontact_figures(named) == pytest.approx(found, abs=2e-3, nan_ok=True)
    k = next(k for k in range(len(tracks["V1"].t_s)) if touch(tracks, k))
    at = k - 20
    if at >= 0 and found["ttc_1_s_before_s"] is not None:
        assert found["ttc_1_s_before_s"] == pytest.approx(swept(tracks, at), abs=0.002)


def moved_track(track, turn, dx, shift):
    c, s = math.cos(turn), math.sin(turn)
    spin = np.array([[c, s], [-s, c]])
    pose = np.column_stack((track.pose[:, :2] @ spin + [dx, -dx], track.pose[:, 2] + turn))
    return Track(track.t_s + shift, pose, track.velocity @ spin, track.size)


def touch(tracks, k):
    return overlap(*(Box(*track.pose[k], *SIZE) for track in tracks.values()))


def swept(tracks, k):
    """Milliseconds until the boxes touch at constant velocity, counted."""
    first, second = tracks.values()
    for t in np.arange(0.0, 3.0, 0.001):
        boxes = [Box(*(tr.pose[k, :2] + t * tr.velocity[k]), tr.pose[k, 2], *SIZE) for tr in (first, second)]
        if overlap(*boxes):
            return float(t)
    return math.inf
