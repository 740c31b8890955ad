"""NHTSA case XML as published: NMVCCS and CIREN, narrative and coded fields.

The published files have CR line ends, Latin-1 bytes under a UTF-8 header and control characters; all are corrected on
reading. Files with a DOCTYPE are refused, so no entity is ever expanded. Knows no folder.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from plugins.report_reader.evidence import EvidenceReader
from sgcad_core.case.records import CrashReport
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import read_regular

MAX_XML_BYTES = 20_000_000
_ILLEGAL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f]")

# our name -> (form, tag); forms are children of the case that carry the vehicle's id
NMVCCS_VEHICLE = {
    "make": ("GeneralVehicle", "MAKE"), "model": ("GeneralVehicle", "MODEL"),
    "body_type": ("GeneralVehicle", "BODY_TYPE"), "transport": ("GeneralVehicle", "TRANSPORT"),
    "lanes": ("GeneralVehicle", "NUM_OF_TRAVEL_LANES"), "flow": ("GeneralVehicle", "TRAFFICWAY_FLOW"),
    "alignment": ("GeneralVehicle", "ROADWAY_ALIGN"), "speed_limit_kph": ("GeneralVehicle", "SPEED_LIMIT"),
    "lane": ("GeneralVehicle", "TRAVEL_LANE"), "junction": ("GeneralVehicle", "RELATION_TO_JUNCTION"),
    "control": ("GeneralVehicle", "TRAFFIC_CONTROL_DEVICE"), "surface": ("GeneralVehicle", "SURFACE_CONDITION"),
    "light": ("GeneralVehicle", "NATURAL_LIGHTING"), "weather": ("GeneralVehicle", "ATMOSPHERICCONDITION"),
    "movement": ("PrecrashAssessmentForm", "PRE_EVENT_MOVEMENT"),
    "critical_event": ("PrecrashAssessmentForm", "CRITICAL_EVENT"),
    "crash_type": ("PrecrashAssessmentForm", "CRASH_TYPE"),
}  # fmt: skip
CIREN_VEHICLE = {
    "make": "Vehicle/Make", "model": "Vehicle/Model", "body_type": "Vehicle/BodyType",
    "speed_limit_kph": "Precrash//PostedSpeedLimit", "lanes": "Precrash//TravelLanes",
    "alignment": "Precrash//Alignment", "junction": "Precrash//RelationToJunction", "light": "Precrash//Light",
    "control": "Precrash//TrafficControlDevices", "surface": "Precrash//SurfaceCondition",
    "movement": "Precrash//PreeventMovement",
}  # fmt: skip


class Case(NamedTuple):
    """Narrative and coded fields of one file."""

    narrative: str
    coded: dict[str, object]


class NhtsaXml(EvidenceReader):
    """Reads NMVCCS and CIREN case XML; coded fields become evidence only with use_coded_fields."""

    def read(self, source: Path) -> CrashReport:
        """Reads one case file. Raises BadInput for hostile, broken and foreign XML."""
        case = parse_case(read_regular(source), source)
        return self.evidence(source, case.narrative, (), case.coded)


def parse_case(raw: bytes, source: Path) -> Case:
    """Narrative and codes of a case file. Raises BadInput for hostile, broken and foreign XML."""
    root = _root(raw, source)
    if root.find("NMVCCS") is not None:
        narrative, coded = _text(root.find(".//XML_CASESUMMARY/SUMMARY")), _nmvccs(root)
    elif root.find("CaseForm") is not None:
        narrative, coded = _text(root.find("CaseForm/CaseSummary/Summary")), _ciren(root)
    else:
        raise BadInput(f"{source}: root <{root.tag}> is neither an NMVCCS nor a CIREN case: "
                       "expected <Case> with <NMVCCS> or <CaseForm>")  # fmt: skip
    if not narrative:
        raise BadInput(f"{source}: the case has no narrative (its summary element is empty)")
    return Case(narrative, coded)


def _root(raw: bytes, source: Path) -> etree._Element:
    if len(raw) > MAX_XML_BYTES:
        raise BadInput(f"{source}: {len(raw):,} bytes of XML, the limit is {MAX_XML_BYTES:,}")
    if b"<!DOCTYPE" in raw or b"<!ENTITY" in raw:
        raise BadInput(f"{source}: has a DOCTYPE; entities are never read: remove it")
    raw = _ILLEGAL.sub(b" ", raw)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        body = raw.decode("cp1252", errors="replace")
        raw = re.sub(r"^\s*<\?xml[^>]*\?>", "", body).encode("utf-8")
    try:
        return etree.fromstring(raw.strip(), parser)
    except etree.XMLSyntaxError as fault:
        raise BadInput(f"{source}: broken XML: {fault.msg}") from fault


def _text(element: etree._Element | None) -> str:
    """Element text with single spaces, paragraphs kept."""
    if element is None:
        return ""
    paragraphs = re.split(r"\n\s*\n", "".join(str(t) for t in element.itertext()).replace("\r", "\n"))
    return "\n\n".join(p for p in (" ".join(x.split()) for x in paragraphs) if p)


def _nmvccs(root: etree._Element) -> dict[str, object]:
    numbers = {
        form.get("VEHICLEID", ""): _text(form.find(".//VEHNUMBER")) for form in root.iterfind(".//GeneralVehicle")
    }
    vehicles = []
    for key, number in sorted(numbers.items(), key=lambda item: item[1]):
        codes: dict[str, object] = {"id": f"V{number}"}
        for name, (form, tag) in NMVCCS_VEHICLE.items():
            found = [_text(e) for f in root.iterfind(f".//{form}") if f.get("VEHICLEID") == key for e in f.iter(tag)]
            codes[name] = next((t for t in found if t.strip(" :")), None)
        vehicles.append(codes)
    events = [_nmvccs_event(e, numbers) for e in root.iter("EVENT")]
    return {"vehicle": vehicles, "event": sorted(events, key=lambda e: str(e["number"]))}


def _nmvccs_event(event: etree._Element, numbers: dict[str, str]) -> dict[str, object]:
    striker = numbers.get(_text(event.find("VEHICLE_STRIKER")))
    return {
        "number": _text(event.find("EVENT_NUMBER")), "actor": f"V{striker}" if striker else None,
        "actor_area": _text(event.find("STRIKER_AREA_DAMAGE")) or None,
        "other": _text(event.find("OBJECT_HIT")).replace("Vehicle#", "V") or None,
        "other_area": _text(event.find("HIT_AREA_DAMAGE")) or None,
    }  # fmt: skip


def _ciren(root: etree._Element) -> dict[str, object]:
    vehicles = []
    for form in root.iterfind("GeneralVehicleForms/GeneralVehicleForm"):
        codes: dict[str, object] = {"id": f"V{form.get('VehicleNumber')}"}
        codes |= {name: _text(form.find(path)) or None for name, path in CIREN_VEHICLE.items()}
        vehicles.append(codes)
    events = [
        {
            "number": e.get("EventNumber"), "actor": f"V{e.get('VehicleNumber')}",
            "actor_area": _text(e.find("AreaOfDamage")) or None,
            "other": _text(e.find("Contacted")).replace("Vehicle#", "V") or None,
            "other_area": _text(e.find("ContactedAreaOfDamage")) or None,
        }
        for e in root.iterfind("CaseForm/Events/EventSum")
    ]  # fmt: skip
    return {"vehicle": vehicles, "event": sorted(events, key=lambda e: str(e["number"]))}
