"""Vehicles that back up: which end leads, and whether a told direction is where they face or where they go."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize(("text", "area"), [
    ("V1 was backing north on a roadway. V1 backed into a fence.", "back"),
    ("V1 was backing north on a roadway and hit a tree.", "back"),
    ("V1 was backing north on a roadway. The left side of V1 hit a tree.", "left"),
    ("V1 was driving north on a roadway and hit a tree.", "front"),
])  # fmt: skip
def test_the_end_that_leads_strikes_a_thing_where_no_side_is_told(text: str, area: str) -> None:
    assert read(text).crash.contacts[0].striker_area == area


@pytest.mark.parametrize(("text", "faces"), [
    ("V1 was backing south down a roadway. V2 was parked. The back of V1 struck the front of V2.", False),
    ("V1 was westbound. V1 pulled to the curb and then backed up. The back of V1 struck the front of V2.", True),
    ("V1 was facing south and backed up. The back of V1 struck the front of V2, which was parked.", True),
])  # fmt: skip
def test_a_way_that_was_driven_before_is_where_a_backing_vehicle_faces(text: str, faces: bool) -> None:
    vehicle = read(text).crash.vehicle("V1")
    assert vehicle is not None
    assert vehicle.maneuver == "backing"
    assert vehicle.faces is faces
