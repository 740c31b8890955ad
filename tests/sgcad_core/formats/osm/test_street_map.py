"""Extracts are read whole, packed or not; what is wrong with one is said with the file, the value and the remedy."""

import bz2
import gzip
from pathlib import Path

import pytest

from sgcad_core import settings
from sgcad_core.errors import ConfigError, SgcadError
from sgcad_core.formats.osm import street_map
from sgcad_core.formats.osm.names import StreetName
from sgcad_core.formats.osm.street_map import maps_in, read_street_map
from tests.sgcad_core.formats.osm.sketches import Sketch

TOWN = settings.CONFIGS / "extracts" / "streets.osm"


def crossing() -> Sketch:
    made = Sketch()
    made.street("Alder Street", [(0, -100), (0, 0), (0, 100)])
    made.street("Birch Avenue", [(-100, 0), (0, 0), (100, 0)], ref="US 7;SR 12")
    return made


@pytest.mark.parametrize(("ending", "pack"), [(".osm", bytes), (".osm.gz", gzip.compress), (".osm.bz2", bz2.compress)])
def test_packed_and_plain_extracts_are_the_same(tmp_path: Path, ending: str, pack: type[bytes]) -> None:
    file = tmp_path / f"a{ending}"
    file.write_bytes(pack(crossing().text().encode()))
    made = read_street_map(file)
    assert [way.tags["name"] for way in made.ways] == ["Alder Street", "Birch Avenue"]
    assert len(made.places) == 5


def test_a_street_is_found_by_any_of_its_names(tmp_path: Path) -> None:
    made = crossing().written(tmp_path)
    for name in (StreetName("birch", "avenue"), StreetName("7", "us", "", True), StreetName("12", "", "", True)):
        assert list(made.named(name)) == [1]
    assert made.named(StreetName("cedar", "street")) == {}


def test_only_the_names_that_fit_best_count(tmp_path: Path) -> None:
    made = Sketch()
    made.street("Alder Street", [(0, 0), (0, 9)])
    made.street("Alder", [(5, 0), (5, 9)])
    assert list(made.written(tmp_path).named(StreetName("alder", "street"))) == [0]


def test_footways_driveways_and_areas_are_no_roads(tmp_path: Path) -> None:
    made = crossing()
    for tags in (
        {"highway": "footway"},
        {"highway": "service"},
        {"highway": "residential", "area": "yes"},
        {"building": "yes"},
    ):
        made.ways.append(([1, 2], tags))
    assert len(made.written(tmp_path).ways) == 2


def test_nodes_beyond_the_rim_of_an_extract_are_left_out(tmp_path: Path) -> None:
    made = crossing()
    made.ways[0][0].append(999)
    assert made.written(tmp_path).ways[0].nodes == (1, 2, 3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<osm><way>", r"no well-formed OpenStreetMap XML.*fetch the extract again"),
        ("nothing", r"no well-formed OpenStreetMap XML"),
        ("<html><way id='1'/></html>", r"begins with <html>"),
        ("<osm></osm>", r"holds no road for cars"),
        ("<osm><way id='1'><nd ref='a'/><tag k='highway' v='primary'/></way></osm>", r"nd \? has ref='a', a number"),
        ("<osm><node id='1' lat='91' lon='0'/></osm>", r"node 1 lies at 91, 0, beyond 90 and 180 degrees"),
        ("<osm><node id='1' lat='x' lon='0'/></osm>", r"node 1 has lat='x', a number is needed"),
        ("<!DOCTYPE osm [<!ENTITY a 'x'><!ENTITY b '&a;&a;'>]><osm>&b;</osm>", r"holds no road|no well-formed"),
    ],
)
def test_a_faulty_extract_is_named_with_what_is_wrong(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "bad.osm"
    file.write_text(text)
    with pytest.raises(ConfigError, match=rf"bad\.osm: .*{said}" if not said.startswith("holds no road|") else said):
        read_street_map(file)


def test_a_torn_packed_extract_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "torn.osm.gz"
    file.write_bytes(gzip.compress(crossing().text().encode())[:-40])
    with pytest.raises(ConfigError, match=r"torn\.osm\.gz: .*fetch the extract again"):
        read_street_map(file)


def test_a_pbf_that_is_none_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "bad.osm.pbf"
    file.write_bytes(b"no pbf")
    with pytest.raises(SgcadError, match=r"bad\.osm\.pbf: (damaged or no \.pbf|\.osm\.pbf needs osmium)"):
        read_street_map(file)


def test_a_huge_extract_is_refused_with_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(street_map, "MOST_MB", 0)
    with pytest.raises(ConfigError, match=r"more than 0 MB of XML; cut out the town"):
        crossing().written(tmp_path)


def test_too_many_roads_are_refused_with_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(street_map, "MOST_WAYS", 1)
    with pytest.raises(ConfigError, match=r"2 roads, at most 1 are read"):
        crossing().written(tmp_path)


def test_an_extract_that_changed_is_read_again(tmp_path: Path) -> None:
    assert len(crossing().written(tmp_path).ways) == 2
    more = crossing()
    more.street("Cedar Street", [(9, 9), (9, 99)])
    assert len(more.written(tmp_path).ways) == 3


def test_a_folder_gives_its_extracts_in_order(tmp_path: Path) -> None:
    for name in ("b.osm", "a.osm.bz2", "notes.txt"):
        (tmp_path / name).write_text("")
    assert [file.name for file in maps_in(tmp_path)] == ["a.osm.bz2", "b.osm"]


def test_a_bundled_extract_is_found_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert maps_in(Path("configs/extracts/streets.osm")) == (TOWN,)


@pytest.mark.parametrize(
    ("name", "said"),
    [("empty", "no extract in this folder"), ("lost.osm", "no such file or folder"), ("a.txt", "unknown kind of file")],
)
def test_a_place_without_maps_is_an_error(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "a.txt").write_text("")
    with pytest.raises(ConfigError, match=rf"{name}: {said}"):
        maps_in(tmp_path / name)
