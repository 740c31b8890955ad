"""netconvert's OpenDRIVE mended to valid OpenDRIVE 1.7.

What is mended: the version; lengths of curves (netconvert writes the polyline's); connectors that do not meet
the lanes they join (uneven stop lines, two lanes that lead into one); straight pieces cut without need; links
of dead ends to junctions that are not in the file; objects without zOffset; the type of two-way left-turn
lanes. Knows no SUMO beyond what its output looks like.
"""

from __future__ import annotations

from collections.abc import Mapping

from lxml import etree

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.check import xodr_findings
from sgcad_core.formats.opendrive.connectors import meet_lanes, split_connectors, true_lengths
from sgcad_core.formats.opendrive.index import RoadEntry, RoadIndex, lane_index
from sgcad_core.formats.xml import Element, parse_xml, to_text
from sgcad_core.records import Finding

__all__ = ["RoadEntry", "RoadIndex", "lane_index", "mend", "xodr_findings"]


def mend(xodr: str) -> str:
    """Valid OpenDRIVE 1.7 from netconvert's 1.4, about 2 ms. Raises InvalidOutput where it is no OpenDRIVE."""
    root = parse_xml(xodr, "xodr")
    header = root.find("header")
    if root.tag != "OpenDRIVE" or header is None:
        finding = Finding(source="xodr", what="no OpenDRIVE file", value=f"<{root.tag}>", remedy="needs a <header>")
        raise InvalidOutput(finding.line(), [finding])
    header.set("revMinor", "7")
    header.attrib.pop("date", None)  # equal networks are equal files
    etree.strip_tags(root, etree.Comment)
    split_connectors(root)
    roads = {road.get("id", ""): road for road in root.iterfind("road")}
    true_lengths(list(roads.values()))
    for road in roads.values():
        _mark_center_lanes(road)
        if road.get("junction", "-1") != "-1":
            meet_lanes(road, roads)
    _drop_dangling(root, roads)
    _complete_objects(root)
    return to_text(root)


# ------------------------------------------------------------------ links, lanes, objects
def _drop_dangling(root: Element, roads: Mapping[str, Element]) -> None:
    """Junctions without a connection go, and so do links to what is not in the file."""
    for junction in root.findall("junction"):
        if junction.find("connection") is None:
            root.remove(junction)
    known = {"junction": {j.get("id") for j in root.iterfind("junction")}, "road": set(roads)}
    for link in root.iterfind("road/link"):
        for end in list(link):
            if end.get("elementId") not in known.get(end.get("elementType", ""), set()):
                link.remove(end)


def _mark_center_lanes(road: Element) -> None:
    """netconvert calls a lane closed to cars restricted; innermost it is a two-way left-turn lane."""
    for lane in road.iterfind("lanes/laneSection/right/lane[@id='-1'][@type='restricted']"):
        lane.set("type", "bidirectional")


def _complete_objects(root: Element) -> None:
    for thing in root.iterfind("road/objects/object"):
        if thing.get("zOffset") is None:
            thing.set("zOffset", "0.0")
