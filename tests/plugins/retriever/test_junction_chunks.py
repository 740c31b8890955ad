"""Real junctions from OpenStreetMap: a small town of our own drawing goes through netconvert."""

import bz2
import gzip
import importlib.util
import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.retriever.knowledge.junction_chunks import junction_chunks
from plugins.retriever.knowledge.sources import file_chunks
from plugins.retriever.lancedb import LanceDB
from sgcad_core.case.records import PlainXml
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.junction_words import JunctionLeg, describe, describe_layout, marks, shape

LAT, LON = 40.0, -80.0
M_LAT, M_LON = 1 / 111_000, 1 / (111_000 * math.cos(math.radians(LAT)))
NODES = {
    1: (0, 0), 2: (0, 300), 3: (0, -300), 4: (-300, 0), 5: (300, 0),  # crossroads with a signal
    6: (300, -300),  # 5 is a T-junction: 4-1-5, 5-6, 5-7
    7: (600, 0), 8: (600, 300), 9: (900, 0),  # 7: another T
}  # fmt: skip
WAYS = {
    100: ([2, 1, 3], {"highway": "primary", "lanes": "4", "name": "Long Street"}),
    101: ([4, 1, 5, 7, 9], {"highway": "residential", "lanes": "2"}),
    102: ([5, 6], {"highway": "residential", "lanes": "2"}),
    103: ([7, 8], {"highway": "tertiary", "lanes": "1", "oneway": "yes"}),
    104: ([6, 8], {"highway": "footway"}),
}


def town_xml():
    lines = ["<?xml version='1.0' encoding='UTF-8'?><osm version='0.6'>"]
    for number, (x, y) in NODES.items():
        tag = "<tag k='highway' v='traffic_signals'/>" if number == 1 else ""
        place = f"lat='{LAT + y * M_LAT:.7f}' lon='{LON + x * M_LON:.7f}'"
        lines.append(f"<node id='{number}' {place} version='1'>{tag}</node>")
    for number, (nodes, tags) in WAYS.items():
        refs = "".join(f"<nd ref='{n}'/>" for n in nodes)
        named = "".join(f"<tag k='{k}' v='{v}'/>" for k, v in tags.items())
        lines.append(f"<way id='{number}' version='1'>{refs}{named}</way>")
    return "\n".join([*lines, "</osm>"])


@pytest.fixture(scope="module")
def town(tmp_path_factory):
    file = tmp_path_factory.mktemp("osm") / "town.osm"
    file.write_text(town_xml())
    return file


@pytest.fixture(scope="module")
def chunks(town):
    skipped = []
    found = list(junction_chunks(town, lambda name, why: skipped.append(why)))
    assert skipped == []
    return {chunk.id.split("/")[-1]: chunk for chunk in found}


def legs_of(chunk):
    return sorted((leg["lanes_in"], leg["lanes_out"]) for leg in json.loads(chunk.data)["legs"])


def test_every_junction_of_three_or_more_legs_is_taken_and_no_other(chunks):
    assert set(chunks) == {"1", "5", "7"}


def test_legs_lanes_and_control_are_those_of_the_map(chunks):
    assert legs_of(chunks["1"]) == [(1, 1), (1, 1), (2, 2), (2, 2)]
    assert legs_of(chunks["5"]) == [(1, 1), (1, 1), (1, 1)]
    assert legs_of(chunks["7"]) == [(0, 1), (1, 1), (1, 1)]
    assert json.loads(chunks["1"].data)["control"] == "signal"


def test_the_words_come_from_the_geometry(chunks):
    assert "four-leg junction (crossroads, four-way intersection), traffic signal" in chunks["1"].text
    assert "T-intersection" in chunks["5"].text
    assert "one-way leg, 1 lane away from it" in chunks["7"].text
    assert "- leg N: 2 lanes in, 2 out; primary" in chunks["1"].text


def test_a_cut_is_a_network_of_its_own(chunks):
    for chunk in chunks.values():
        network = compile_network(PlainXml(**json.loads(chunk.data)["plain"]))
        assert network.xodr, network.log


@pytest.mark.parametrize(("ending", "pack"), [(".osm.gz", gzip.compress), (".osm.bz2", bz2.compress)])
def test_packed_extracts_give_the_same_junctions(chunks, tmp_path, ending, pack):
    file = tmp_path / f"town{ending}"
    file.write_bytes(pack(town_xml().encode()))
    found = {c.id.split("/")[-1]: c for c in junction_chunks(file, pytest.fail)}
    assert found == chunks


@pytest.mark.skipif(importlib.util.find_spec("osmium") is None, reason="needs the extra 'osm' (osmium)")
def test_a_pbf_gives_the_same_junctions(chunks, town, tmp_path):
    import osmium

    file = tmp_path / "town.osm.pbf"
    with osmium.SimpleWriter(str(file)) as writer:
        for item in osmium.FileProcessor(str(town)):
            writer.add(item)
    found = {c.id.split("/")[-1]: c for c in junction_chunks(file, pytest.fail)}
    assert {name: legs_of(c) for name, c in found.items()} == {name: legs_of(c) for name, c in chunks.items()}
    assert found["1"].text == chunks["1"].text


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("bad.osm", b"this is no map", "netconvert cannot read it"),
        ("bad.osm.bz2", b"this is not packed", "damaged"),
        ("town.shp", b"", "unknown kind of file"),
        ("own.jsonl", b'{"id": "x"}\n', r"own.jsonl, line 1: kind: Field required"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises((ConfigError, MissingTool), match=says):
        list(file_chunks(tmp_path / name, pytest.fail))


def test_a_layout_finds_the_junction_like_it(town, tmp_path):
    index = LanceDB(folder=tmp_path / "kb", kinds=("junction",))
    index.build(index.chunks([town], False, pytest.fail), lambda n: None)
    wide, narrow = {"lanes_in": 2, "lanes_out": 2}, {"lanes_in": 1, "lanes_out": 1}
    cross = RoadLayout(legs=(Leg(bearing="NE", **wide), Leg(bearing="SW", **wide), Leg(bearing="SE", **narrow),
                             Leg(bearing="NW", **narrow)))  # fmt: skip
    assert index.search(describe_layout(cross), 1)[0].id == "junction/town/1"
    tee = RoadLayout(legs=tuple(Leg(bearing=b, **narrow) for b in ("N", "E", "W")))
    assert index.retrieve(describe_layout(tee), "road")[0].id == "junction/town/5"


LEGS = st.lists(st.builds(JunctionLeg, st.floats(-7, 7), st.integers(0, 5), st.integers(0, 5)), min_size=3, max_size=8)


@given(LEGS, st.floats(-7, 7), st.randoms())
@settings(max_examples=60, deadline=None)
def test_marks_and_counts_do_not_depend_on_order_or_direction(legs, turn, random):
    turned = [leg._replace(angle_rad=leg.angle_rad + turn) for leg in legs]
    random.shuffle(turned)
    assert marks(turned) == marks(legs)
    assert describe(turned, "none").split(";")[1:] == describe(legs, "none").split(";")[1:]
    assert max(map(len, marks(legs).split())) <= 40, "longer words are not indexed"


@pytest.mark.parametrize(
    ("degrees", "word"),
    [((0, 90, 180), "T-intersection, side road"), ((0, 90, 180, 270), "crossroads"), ((0, 120, 240), "Y-intersection"),
     ((0, 180, 205), "T-intersection, skewed"), ((0, 45, 180, 225), "skewed"), ((0, 72, 144, 216, 288), "multi-leg"),
     ((0, 10, 30), "merge or fork")],
)  # fmt: skip
def test_a_shape_has_its_name(degrees, word):
    assert word in shape([JunctionLeg(math.radians(d), 1, 1) for d in degrees])
