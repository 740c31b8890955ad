"""Roads of the rivals that draw nothing: the nearest junction of an index, the nearest map of a library."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from plugins.retriever.lancedb import LanceDB
from plugins.road_writer._map_search import library
from plugins.road_writer.map_library import MapLibrary
from plugins.road_writer.osm_direct import OsmDirect
from plugins.road_writer.template import Template
from plugins.road_writer.text2scenario import SceneLayout, layout_of_scene
from sgcad_core import settings
from sgcad_core.case.records import Context, Generation, Query, RoadNetwork
from sgcad_core.errors import ConfigError, Refused
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net
from sgcad_core.interfaces import RoadWriter
from sgcad_core.records.specs import RoadLayout

CROSSING = (
    "V1 was traveling north on a four-lane, two-way road and was approaching a four-leg intersection with a traffic "
    "signal. V2 was traveling west on the intersecting two-lane road. V1 struck the left side of V2."
)
PLAIN = "V1 was traveling east on a two-lane road and struck the rear of V2."


def never(context: Context, query: Query) -> Generation:
    raise AssertionError("asks no model")


def write(writer: RoadWriter, text: str) -> RoadNetwork:
    return writer.write(Context(narrative=text), (), (), never, 1)


def lanes(network: RoadNetwork) -> list[tuple[int, int]]:
    """(in, out) of the roads at the hub."""
    assert network.spec
    assert network.net_xml, network.log
    hub = max(network.spec.nodes, key=lambda n: sum(n.id in (r.from_node, r.to_node) for r in network.spec.roads)).id  # type: ignore[union-attr]
    ends = [(r.lanes_forward, r.lanes_backward) if r.to_node == hub else (r.lanes_backward, r.lanes_forward)
            for r in network.spec.roads if hub in (r.from_node, r.to_node)]  # fmt: skip
    return sorted(ends)


@pytest.fixture(scope="module")
def index(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    folder = tmp_path_factory.mktemp("kb")

    def build(name: str) -> Path:
        made = LanceDB(folder=folder / name)
        if not made.folder.exists():
            file = settings.CONFIGS / "extracts" / f"{name}.osm"
            made.build(made.chunks([file], False, lambda *_: None), lambda _: None)
        return made.folder

    return build


# ------------------------------------------------------------------ OSM-Direct
def test_the_nearest_real_junction_is_taken_and_lies_as_told(index: Callable[[str], Path]) -> None:
    network = write(OsmDirect(folder=index("town")), CROSSING)
    assert network.source == "openstreetmap"
    assert lanes(network) == [(1, 1), (1, 1), (2, 2), (2, 2)]
    assert network.log.startswith("osm_direct: junction/town/")
    assert network.spec
    wide = [r for r in network.spec.roads if r.lanes_forward == 2]
    places = {n.id: n for n in network.spec.nodes}
    for road in wide:  # the four-lane road runs north and south, as told
        ends = places[road.from_node], places[road.to_node]
        assert abs(ends[0].y_m - ends[1].y_m) > 5 * abs(ends[0].x_m - ends[1].x_m)


def test_a_map_from_far_away_gives_what_it_has(index: Callable[[str], Path]) -> None:
    near, far = (
        sum(map(sum, lanes(write(OsmDirect(folder=index(name), among=20), CROSSING)))) for name in ("town", "far_city")
    )
    assert (near, far) == (12, 24)


def test_a_plain_road_gets_a_junction_too_since_an_index_holds_nothing_else(index: Callable[[str], Path]) -> None:
    network = write(OsmDirect(folder=index("town")), PLAIN)
    assert network_figures(parse_net(network.net_xml or "")).intersections >= 1


def test_its_stamp_is_that_of_the_index(index: Callable[[str], Path], tmp_path: Path) -> None:
    folder = index("town")
    assert OsmDirect(folder=folder).stamp == LanceDB(folder=folder).stamp != ""
    with pytest.raises(ConfigError, match="build it with `sgcad index build --out"):
        _ = OsmDirect(folder=tmp_path / "none").stamp


def test_an_index_without_junctions_says_how_to_add_some(tmp_path: Path) -> None:
    file = tmp_path / "own.jsonl"
    chunk = {"id": "a", "kind": "xml", "tasks": ["road"], "title": "edge", "text": "an edge"}
    file.write_text(json.dumps(chunk))
    made = LanceDB(folder=tmp_path / "kb")
    made.build(made.chunks([file], False, lambda *_: None), lambda _: None)
    with pytest.raises(ConfigError, match=r"holds no junction: `sgcad index add EXTRACT\.osm\.pbf --out"):
        write(OsmDirect(folder=made.folder), CROSSING)


@pytest.mark.parametrize("text", ["", "The patient slept well and ate breakfast."])
def test_a_text_without_a_crash_is_refused(index: Callable[[str], Path], text: str) -> None:
    for writer in (OsmDirect(folder=index("town")), MapLibrary()):
        with pytest.raises(Refused, match="neither a vehicle nor a road"):
            write(writer, text)


# ------------------------------------------------------------------ existing maps
def test_the_librarys_maps_differ_in_name_and_words() -> None:
    maps = library(None)
    assert len(maps) == len({m.name for m in maps}) == 20
    assert all(m.layout for m in maps)


@pytest.mark.parametrize(("text", "name"), [
    (CROSSING, "crossing_four_and_two_lanes_signal"), (PLAIN, "straight_two_lanes"),
])  # fmt: skip
def test_the_map_most_like_the_report_is_taken(text: str, name: str) -> None:
    network = write(MapLibrary(), text)
    assert (network.source, network.log.split()[1].rstrip(",")) == ("map_library", name)
    assert network.net_xml
    assert network.layout


def test_a_folder_of_maps_replaces_the_projects_own(tmp_path: Path) -> None:
    (tmp_path / "cross.net.xml").write_text(write(Template(), CROSSING).net_xml or "")
    (tmp_path / "plain.xodr").write_text(write(Template(), PLAIN).xodr or "")
    network = write(MapLibrary(folder=tmp_path), CROSSING)
    assert network.log.startswith("map_library: cross.net.xml")
    assert network_figures(parse_net(network.net_xml or "")).intersections == 1
    assert write(MapLibrary(folder=tmp_path), PLAIN).log.startswith("map_library: plain.xodr")


def test_an_empty_folder_is_named_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"no map library; put \.net\.xml or \.xodr files there"):
        write(MapLibrary(folder=tmp_path), CROSSING)


# ------------------------------------------------------------------ Text2Scenario's templates
@pytest.mark.parametrize(("form", "bearings"), [
    ({"place": "straight_road", "main_heading": "E"}, ["E", "W"]),
    ({"place": "crossing"}, ["N", "E", "S", "W"]),
    ({"place": "t_junction", "cross_bearing": "W"}, ["N", "S", "W"]),
    ({"place": "t_junction", "main_heading": "E"}, ["E", "S", "W"]),
    ({"place": "driveway", "cross_bearing": "N"}, ["N", "S"]),
])  # fmt: skip
def test_a_form_becomes_legs(form: dict[str, str], bearings: list[str]) -> None:
    layout = layout_of_scene(SceneLayout.model_validate(form))
    assert sorted(leg.bearing for leg in layout.legs) == sorted(bearings)


def test_lanes_control_and_direction_of_a_form_stand_on_its_legs() -> None:
    form = {"place": "crossing", "main_lanes": 3, "main_one_way": True, "cross_lanes": 2, "control": "stop"}
    legs = {leg.bearing: leg for leg in layout_of_scene(SceneLayout.model_validate(form)).legs}
    assert [(legs[b].lanes_in, legs[b].lanes_out, legs[b].control) for b in ("N", "S", "E", "W")] == [
        (0, 3, "none"), (3, 0, "none"), (2, 2, "stop"), (2, 2, "stop"),
    ]  # fmt: skip


def test_a_merge_and_a_curve_have_their_templates() -> None:
    merge = layout_of_scene(SceneLayout(place="merge", main_one_way=True))
    assert [(leg.bearing, leg.kind, leg.lanes_in) for leg in merge.legs if leg.kind == "ramp"] == [("SE", "ramp", 1)]
    curve: RoadLayout = layout_of_scene(SceneLayout(place="curved_road"))
    assert [leg.curve for leg in curve.legs] == ["left", "right"]
