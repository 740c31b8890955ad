"""A SUMO route file of background vehicles: `sumo -n road.net.xml -r traffic.rou.xml` drives them without the crash."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from sgcad_core.case.traffic import Entrant

FILE = "traffic.rou.xml"
LANE_KEEPING = {"lcStrategic": "-1", "lcCooperative": "-1", "lcSpeedGain": "0", "lcKeepRight": "0"}


def traffic_routes(entrants: Sequence[Entrant]) -> str:
    """The file's text: a type for each size, and the vehicles by the time of their departure."""
    root = ET.Element("routes")
    sizes = {e.kind: (e.length_m, e.width_m) for e in entrants}
    for kind, (length, width) in sorted(sizes.items()):
        size = {"length": f"{length:g}", "width": f"{width:g}"}
        ET.SubElement(root, "vType", {"id": kind, "vClass": "passenger", **size, **LANE_KEEPING})
    for e in sorted(entrants, key=lambda entrant: entrant.depart_s):
        told = {"id": e.id, "type": e.kind, "depart": f"{e.depart_s:.2f}", "departLane": str(e.lane)}
        vehicle = ET.SubElement(root, "vehicle", {**told, "departPos": f"{e.at_m:.3f}", "departSpeed": "max"})
        ET.SubElement(vehicle, "route", {"edges": " ".join(e.route)})
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'
