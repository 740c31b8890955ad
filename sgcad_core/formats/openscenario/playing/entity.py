"""Scenario objects to bodies: boxes, limits, hitches and selections of entities."""

from __future__ import annotations

from sgcad_core.formats.openscenario.playing.body import Body, Limits
from sgcad_core.formats.openscenario.playing.timed_motion import BoxShape
from sgcad_core.formats.openscenario.reading.elements import XmlNode

MAX_ENTITIES = 200
MAX_TRAILERS = 10
LEAST_M = 0.1
"""Side of a box that a file gives none."""
MOST_M = 500.0
"""Longest side of a box: longer than any ship."""
KINDS = ("Vehicle", "Pedestrian", "MiscObject")
_BY_TYPE = {"vehicle": "Vehicle", "pedestrian": "Pedestrian", "miscellaneous": "MiscObject", "miscObject": "MiscObject"}


def bodies_of(root: XmlNode) -> dict[str, Body]:
    """Bodies by entity name in file order. Raises InvalidOutput."""
    holder = root.need("Entities")
    objects = holder.children("ScenarioObject")
    for other in holder.children():
        if other.tag not in ("ScenarioObject", "EntitySelection"):
            raise other.unsupported()
    if not 1 <= len(objects) <= MAX_ENTITIES:
        raise holder.fault(f"needs 1 to {MAX_ENTITIES} scenario objects", str(len(objects)))
    bodies: dict[str, Body] = {}
    for node in objects:
        if (name := node.text("name")) in bodies:
            raise node.fault("two entities have this name", name, "rename one")
        bodies[name] = _body(node, name)
    _hitch_on(objects, bodies)
    return bodies


def selections_of(root: XmlNode, bodies: dict[str, Body]) -> dict[str, tuple[str, ...]]:
    """Members of each <EntitySelection>."""
    found: dict[str, tuple[str, ...]] = {}
    for node in root.need("Entities").children("EntitySelection"):
        members = node.need("Members")
        names = [ref.text("entityRef") for ref in members.children("EntityRef")]
        if unknown := next((n for n in names if n not in bodies), None):
            raise members.fault("unknown entity", unknown, f"entities: {', '.join(bodies)}")
        kinds = {_BY_TYPE[t.choice("objectType", _BY_TYPE)] for t in members.children("ByType")}
        names += [name for name, body in bodies.items() if body.kind in kinds and name not in names]
        found[node.text("name")] = tuple(names)
    return found


def _body(node: XmlNode, name: str) -> Body:
    return _of(entity_node(node), name)


def _of(found: XmlNode, name: str) -> Body:
    box = _box(found)
    made = Body(name, box, found.tag, found.text("vehicleCategory", ""))
    if performance := found.find("Performance"):
        limits = (performance.limit(k) for k in ("maxSpeed", "maxAcceleration", "maxDeceleration"))
        made.limits = Limits(*limits)
    for holder in found.children("Properties"):
        for entry in holder.children("Property"):
            if entry.text("name", "") == "refpoint_x_offset":
                made.lead_m = entry.number("value")
    made.hitch_m, made.coupler_m = (_dx(found, tag) for tag in ("TrailerHitch", "TrailerCoupler"))
    return made


def entity_node(node: XmlNode) -> XmlNode:
    """The <Vehicle>, <Pedestrian> or <MiscObject> of a scenario object, from its catalog where it refers to one."""
    child = node.find(*KINDS, "CatalogReference")
    if child is None:
        raise node.unsupported("needs a <Vehicle>, <Pedestrian>, <MiscObject> or a <CatalogReference> to one")
    return child.followed(*KINDS)


def _box(found: XmlNode) -> BoxShape:
    box = found.need("BoundingBox")
    size, center = box.need("Dimensions"), box.need("Center")
    ahead = center.number("x") - _rear_axle_m(found)
    return BoxShape(_side(size, "length"), _side(size, "width"), ahead, center.number("y"))


def _rear_axle_m(found: XmlNode) -> float:
    """Where a vehicle's rear axle stands in its own coordinates: 0, since it is their origin.

    A file that says otherwise contradicts itself; like other players this one believes that poses are the rear
    axle's, and moves box and front axle along. 0 for entities without axles.
    """
    axles = found.find("Axles")
    rear = axles.find("RearAxle") if axles else None
    return rear.number("positionX") if rear else 0.0


def _side(size: XmlNode, name: str) -> float:
    if size.number(name) == 0 and not size.book.strict:
        size.note(f"attribute {name!r} is 0", remedy=f"played with {LEAST_M:g} m")
        return LEAST_M
    if (side := size.positive(name)) > MOST_M:
        raise size.fault(f"attribute {name!r} must be at most {MOST_M:g} m", f"{side:g}")
    return side


def _dx(found: XmlNode, tag: str) -> float | None:
    return node.number("dx", 0.0) if (node := found.find(tag)) else None


def _hitch_on(objects: list[XmlNode], bodies: dict[str, Body]) -> None:
    """Trailers that vehicles have from the start."""
    for node in objects:
        _hitched(entity_node(node), bodies[node.text("name")], bodies)


def _hitched(vehicle: XmlNode, body: Body, bodies: dict[str, Body], depth: int = 0) -> None:
    trailer = vehicle.find("Trailer")
    if trailer is None:
        return
    if inner := trailer.find("Trailer"):
        if depth > MAX_TRAILERS:
            raise inner.fault(f"more than {MAX_TRAILERS} trailers in a row")
        own = inner.either("Vehicle")
        name = f"{body.name}+"
        bodies[name] = made = _of(own, name)
        made.tow = body
        _hitched(own, made, bodies, depth + 1)
        return
    holder = trailer.find("TrailerRef", "EntityRef")
    if holder is None:
        raise trailer.unsupported("what it pulls is not said", "name it in a <TrailerRef>")
    if name := holder.text("entityRef"):
        if name not in bodies:
            raise holder.fault("unknown entity", name, f"entities: {', '.join(bodies)}")
        bodies[name].tow = body
