"""First contact: exact, symmetric, blind to scenery."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.case.records import ClosestApproach
from sgcad_core.execution.contact import avoided, first_contact, moves
from sgcad_core.geometry.distances import box_distance, distance_to
from sgcad_core.geometry.plane import Box, overlap
from sgcad_core.records.specs import Contact, NearCrash
from tests.sgcad_core.formats.xosc_samples import trajectory

K = np.arange(200)
SIZES = dict.fromkeys(("V1", "V2", "V3", "O1", "O2"), (4.0, 2.0))


def test_a_rear_end_is_front_against_back_in_the_first_touching_row():
    striker, struck = trajectory("V2", K * 0.5, 0), trajectory("V1", 20 + 0 * K, 0.3)
    contact = first_contact([striker, struck], SIZES)
    assert (contact.actor, contact.actor_area, contact.other, contact.other_area) == ("V1", "back", "V2", "front")
    assert contact.t_s == 1.6, "16 m at 10 m/s; touching counts"


def test_areas_are_those_of_each_actor():
    crossing = trajectory("V1", 0 * K, K * 0.5 - 30, np.pi / 2)
    contact = first_contact([crossing, trajectory("V2", 0 * K, 0, 0.0)], SIZES)
    assert (contact.actor_area, contact.other_area) == ("front", "right")


def test_nothing_touches():
    assert first_contact([trajectory("V1", K * 0.5, 0), trajectory("V2", K * 0.5, 2.01)], SIZES) is None
    assert first_contact([], SIZES) is None


def test_of_pairs_in_one_row_the_first_by_id_counts():
    middle = trajectory("V2", K * 0.5, 0)
    ends = [trajectory("V3", 30 + 0 * K, 1.5), trajectory("V1", 30 + 0 * K, -1.5)]
    assert first_contact([middle, *ends], SIZES).actor == "V1"


def test_scenery_that_overlaps_itself_is_no_contact():
    scenery = [trajectory("O1", 0 * K, 0), trajectory("O2", 0 * K + 1, 0)]
    assert first_contact(scenery, SIZES) is None
    contact = first_contact([*scenery, trajectory("V1", K * 0.5 - 40, 0)], SIZES)
    assert (contact.actor, contact.other) == ("O1", "V1")


def test_an_overlap_from_the_start_counts_where_one_of_them_moves():
    towed = [trajectory("V1", K * 0.5, 0), trajectory("V2", K * 0.5 - 1, 0)]
    assert first_contact(towed, SIZES).t_s == 0.0
    assert moves(towed[0])
    assert not moves(trajectory("V1", 0 * K, 0))


BOXES = st.builds(Box, st.floats(-20, 20), st.floats(-20, 20), st.floats(-4, 4), st.floats(0.3, 12), st.floats(0.3, 3))


@settings(max_examples=60, deadline=None)
@given(BOXES, BOXES)
def test_box_distance_agrees_with_a_dense_outline(a, b):
    distance = box_distance(a, b)
    assert distance == box_distance(b, a)
    assert (distance == 0) == overlap(a, b)
    if distance > 0:
        near = distance_to(outline(b), outline(a)).min()
        assert distance <= near + 1e-9
        assert near - distance < 0.2


def outline(box):
    share = np.linspace(-1, 1, 61)[:, None]
    sides = [np.hstack((share, np.full_like(share, e))) for e in (-1, 1)]
    ring = np.vstack([*sides, *(s[:, ::-1] for s in sides)]) * [box.length_m / 2, box.width_m / 2]
    c, s = np.cos(box.heading_rad), np.sin(box.heading_rad)
    return ring @ np.array([[c, s], [-s, c]]) + [box.x_m, box.y_m]


@pytest.mark.parametrize(("told_m", "found_m", "expected"), [
    (None, 0.41, True), (None, 1.4, True), (None, 0.05, False), (None, 2.0, False), (0.6, 0.62, True),
    (0.6, 0.7, False),
])  # fmt: skip
def test_a_clearance_that_is_not_told_may_be_any_near_one(told_m, found_m, expected):
    conflict = Contact(striker="V1", struck="V2", striker_area="front", struck_area="back")
    near = NearCrash(conflict=conflict, clearance_m=told_m)
    closest = ClosestApproach(actor="V1", other="V2", clearance_m=found_m, t_s=1.0)
    assert avoided(near, None, closest) is expected
