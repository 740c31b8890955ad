"""The plane at a place: lengths of degrees as the tables have them, and back again."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.geometry.globe import Plane


@pytest.mark.parametrize(
    ("latitude", "north_m", "east_m"), [(0, 110_574.3, 111_319.5), (45, 111_131.8, 78_846.8), (60, 111_412.2, 55_800.0)]
)
def test_a_degree_is_as_long_as_the_tables_say(latitude: float, north_m: float, east_m: float) -> None:
    step = 1e-4
    x, y = Plane(latitude, 10.0).metres((latitude + step, 10.0 + step))
    assert (x / step, y / step) == pytest.approx((east_m, north_m), abs=0.3)


@given(st.floats(-70, 70), st.floats(-179, 179), st.floats(-1000, 1000), st.floats(-1000, 1000))
def test_a_point_comes_back(latitude: float, longitude: float, x: float, y: float) -> None:
    plane = Plane(latitude, longitude)
    assert math.dist(plane.metres(plane.spot(x, y)), (x, y)) < 1e-5


def test_the_projection_names_the_place() -> None:
    assert Plane(0, 0).proj == "+proj=tmerc +lat_0=0 +lon_0=0 +k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m"
    assert Plane(40.1234567, -99.5).proj.startswith("+proj=tmerc +lat_0=40.1234567 +lon_0=-99.5 ")
