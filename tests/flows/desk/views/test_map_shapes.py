"""The desk's map of a case's folder."""

import numpy as np

from flows.desk.views.map_shapes import BESIDE_M, map_of
from flows.player.road_shapes import drawing_of
from sgcad_core.geometry.distances import distance_to
from tests.flows.player.test_overview_pngs import NET


def test_names_of_roads_stand_beside_them(tmp_path):
    (tmp_path / "road.net.xml").write_text(NET)
    made = map_of(tmp_path, {})
    assert {name for name, _, _ in made.names} == {"a", "b"}
    for _, x, y in made.names:
        off = [
            float(distance_to(strip.points, np.array([[x, -y]]))[0]) - strip.width_m / 2
            for strip in drawing_of(NET).strips
        ]
        assert min(off) >= BESIDE_M - 0.2
