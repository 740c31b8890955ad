"""The template writer on a real place: headings, lanes and limits in both files, and where they lie on the globe."""

import math
import subprocess
import sys
from pathlib import Path

import pytest

from plugins.road_writer.template import Template
from sgcad_core import settings
from sgcad_core.case.records import Context, Generation, Query, RoadNetwork
from sgcad_core.errors import ConfigError
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.globe import Plane
from sgcad_core.roads.compiled_facts import junctions

TOWN = settings.CONFIGS / "extracts" / "streets.osm"
TEXT = (
    "V1 was northbound on N Maple St. V2 was eastbound on East 5th Ave. "
    "The front of V1 struck the right side of V2 in the intersection."
)


def never(context: Context, query: Query) -> Generation:
    raise AssertionError("a template asks no model")


def write(text: str, places: Path | None = TOWN) -> RoadNetwork:
    network = Template(places=places).write(Context(narrative=text), (), (), never, 1)
    assert network.net_xml, network.log
    assert network.xodr
    return network


def test_compiled_legs_lie_as_on_the_map() -> None:
    found = sorted(round(90 - math.degrees(leg)) % 360 for leg in junctions(parse_net(write(TEXT).net_xml or ""))[0])
    assert found == pytest.approx([12, 102, 192, 282], abs=2)


def test_both_files_name_the_place_on_the_globe() -> None:
    network = write(TEXT)
    assert network.place
    assert network.place.origin
    wanted = Plane(*network.place.origin).proj
    location = parse_xml(network.net_xml or "", "net").find("location")
    assert location.get("projParameter") == wanted
    assert parse_xml(network.xodr or "", "xodr").find("header/geoReference").text == wanted
    west, south, east, north = map(float, location.get("origBoundary").split(","))
    assert south < network.place.origin[0] < north
    assert west < network.place.origin[1] < east


def test_sumo_puts_the_hub_where_the_streets_meet(tmp_path: Path) -> None:
    network = write(TEXT)
    file = tmp_path / "road.net.xml"
    file.write_text(network.net_xml or "")
    start = f"from libsumo import simulation, start; start(['sumo', '-n', {str(file)!r}])"
    code = f"{start}; [print(*simulation.convertGeo(at, at)) for at in (0, 100)]"
    done = subprocess.run(
        [sys.executable, "-c", code], env=settings.subprocess_environment(), capture_output=True, text=True, check=True
    )
    hub, beyond = ([float(v) for v in line.split()] for line in done.stdout.strip().splitlines()[-2:])
    assert network.place
    assert network.place.origin
    assert hub[::-1] == pytest.approx(network.place.origin, abs=1e-6)
    assert beyond[::-1] == pytest.approx(Plane(*network.place.origin).spot(100, 100), abs=1e-6)


def test_netconvert_has_nothing_to_say_of_the_place() -> None:
    assert "proj" not in write(TEXT).log


def test_limits_of_the_map_are_posted() -> None:
    xodr = parse_xml(write(TEXT).xodr or "", "xodr")
    assert {speed.get("max") for speed in xodr.iterfind("road/type/speed")} == {"35", "30"}


def test_a_place_that_is_not_found_leaves_the_road_as_it_was() -> None:
    text = TEXT.replace("Maple", "Pine")
    network, plain = write(text), write(text, None)
    assert (network.net_xml, network.xodr) == (plain.net_xml, plain.xodr)
    assert network.place
    assert not network.place.found
    assert plain.place is None


def test_the_stamp_names_the_maps() -> None:
    assert Template().stamp == ""
    assert Template(places=TOWN).stamp == f"streets.osm {TOWN.stat().st_size}"


def test_places_that_are_not_there_stop_before_anything_starts() -> None:
    with pytest.raises(ConfigError, match=r"lost\.osm: no such file or folder; give an OpenStreetMap extract"):
        _ = Template(places=Path("lost.osm")).stamp
