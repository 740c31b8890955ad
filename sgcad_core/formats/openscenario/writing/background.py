"""Background traffic put into a written scenario: entities, starts and a story of their own; the crash stays as it is.

Every vehicle follows a timed polyline, as the actors of `writer` do, and has the property `role` = `traffic`. Knows
scenario files; not how the traffic came about.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.case.traffic import ROLE
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, VERSIONS, Version
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import Element, parse_xml

_SPLICES = (
    ("Entities", "Entities", "ScenarioObject"), ("Storyboard/Init/Actions", "Storyboard/Init/Actions", "Private"),
)  # fmt: skip


def with_background(xosc: str, vehicles: Sequence[ActorInfo], trajectories: Sequence[Trajectory]) -> str:
    """The scenario with background vehicles on the scenario's clock; at least two rows each.

    Raises InvalidOutput where the file has no place for them, or an entity of the same name.
    """
    root = parse_xml(xosc, "scenario.xosc")
    _check(root, vehicles)
    added = parse_xml(write_xosc(vehicles, trajectories, None, version=_version(root)), "traffic")
    for vehicle in added.iterfind("Entities/ScenarioObject"):
        _mark(vehicle)
    for place, source, tag in _SPLICES:
        _append(root.find(place), added.findall(f"{source}/{tag}"))
    story = added.find("Storyboard/Story")
    story.set("name", ROLE)
    story.find("Act").set("name", f"{ROLE}_act")
    last = root.findall("Storyboard/Story")[-1]
    story.tail = last.tail
    last.addnext(story)
    return _text(xosc, root)


def without_background(xosc: str) -> str:
    """The scenario as it was before `with_background`; any other one unchanged. Raises InvalidOutput for no XML."""
    if f'value="{ROLE}"' not in xosc:
        return xosc
    root = parse_xml(xosc, "scenario.xosc")
    marked = root.xpath("Entities/ScenarioObject[*/Properties/Property[@name='role' and @value=$role]]", role=ROLE)
    names = {vehicle.get("name") for vehicle in marked}
    starts = [e for e in root.iterfind("Storyboard/Init/Actions/Private") if e.get("entityRef") in names]
    for element in (*marked, *starts, *root.xpath("Storyboard/Story[@name=$role]", role=ROLE)):
        element.getparent().remove(element)
    return _text(xosc, root)


def _version(root: Element) -> Version:
    told = f"1.{root.find('FileHeader').get('revMinor')}"
    return next((version for version in VERSIONS if version == told), DEFAULT_VERSION)


def _check(root: Element, vehicles: Sequence[ActorInfo]) -> None:
    lacking = [name for name in ("FileHeader", "Entities", "Storyboard/Init/Actions", "Storyboard/Story")
               if root.find(name) is None]  # fmt: skip
    if lacking:
        raise InvalidOutput(f"scenario.xosc has no {', '.join(lacking)}: traffic cannot be added to it")
    taken = {entity.get("name") for entity in root.iterfind("Entities/ScenarioObject")}
    if both := [vehicle.id for vehicle in vehicles if vehicle.id in taken]:
        raise InvalidOutput(f"scenario.xosc has an entity {both[0]} already: traffic needs names of its own")


def _mark(vehicle: Element) -> None:
    """Say in an entity's properties that it is background."""
    properties = vehicle.find("*/Properties")
    properties.append(properties.makeelement("Property", {"name": "role", "value": ROLE}))


def _append(place: Element, elements: Sequence[Element]) -> None:
    for element in elements:
        place.append(element)


def _text(xosc: str, root: Element) -> str:
    """The document with its declaration and the comments before the root, indented as ours are."""
    from lxml import etree

    etree.indent(root, space="  ")
    head = re.match(r"\s*(<\?xml[^>]*\?>\s*)?(<!--.*?-->\s*)*", xosc, re.DOTALL)
    text: str = etree.tostring(root, encoding="unicode", with_tail=False)
    return f"{head[0] if head else ''}{text}\n"
