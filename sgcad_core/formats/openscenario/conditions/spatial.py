"""Conditions on where an entity is: at a place, near another, in contact, so many seconds away."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.conditions.rules import BY_ENTITY, OfEntity, rule
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.distances import KINDS, STRAIGHT, apart, box_of, system_of
from sgcad_core.formats.openscenario.playing.positions import position
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.geometry.plane import overlap

_TYPES = {"vehicle": "Vehicle", "pedestrian": "Pedestrian", "miscellaneous": "MiscObject", "miscObject": "MiscObject"}


def _other(node: XmlNode, holder: XmlNode) -> Callable[[Scene], Body | Pose]:
    """The entity or the place that a condition measures to."""
    if ref := holder.find("EntityRef"):
        name = ref.text("entityRef")
        return lambda scene: scene.body(name, node)
    if place := holder.find("Position"):
        where = position(place)
        return lambda scene: where(scene).pose
    name = node.text("entityRef")
    return lambda scene: scene.body(name, node)


def _how(node: XmlNode, kind: str) -> tuple[str, str, bool]:
    """Kind, coordinate system and free space of a distance."""
    system = system_of(node)
    default = "longitudinal" if node.has("alongRoute") and system == "road" else kind
    return node.choice("relativeDistanceType", KINDS, default), system, node.flag("freespace")


BESIDE_M = 1e-6
"""An entity that is not farther ahead than this counts as beside."""


@BY_ENTITY.plays("ReachPositionCondition")
def _reach(node: XmlNode) -> OfEntity:
    target, tolerance = position(node.need("Position")), node.number("tolerance")

    def test(scene: Scene, name: str) -> bool:
        return math.dist(target(scene).pose[:2], scene.pose(name, node)[:2]) <= tolerance + EPSILON

    return test


@BY_ENTITY.plays("DistanceCondition", "RelativeDistanceCondition")
def _distance(node: XmlNode) -> OfEntity:
    holds, other, how = rule(node), _other(node, node), _how(node, "euclidianDistance")
    return lambda scene, name: holds(abs(apart(scene, scene.body(name, node), other(scene), how, node)))


@BY_ENTITY.plays("TimeHeadwayCondition", remark="undefined behind the other, beside it, and at a stand")
def _headway(node: XmlNode) -> OfEntity:
    holds, other, how = rule(node), _other(node, node), _how(node, "euclidianDistance")

    def test(scene: Scene, name: str) -> bool:
        body = scene.body(name, node)
        gap = _ahead(scene, body, other(scene), how, node)
        return gap >= 0 and body.speed_mps > EPSILON and math.isfinite(gap) and holds(gap / body.speed_mps)

    return test


@BY_ENTITY.plays("TimeToCollisionCondition", remark="undefined while they part")
def _time_to_collision(node: XmlNode) -> OfEntity:
    """Distance by closing speed: the own velocity along the other's, less the other's speed."""
    holder = node.find("TimeToCollisionConditionTarget") or node
    holds, other, how = rule(node), _other(node, holder), _how(node, "euclidianDistance")

    def test(scene: Scene, name: str) -> bool:
        body, target = scene.body(name, node), other(scene)
        gap, closing = _ahead(scene, body, target, how, node), _closing(body, target)
        if not math.isfinite(gap) or abs(gap) < EPSILON or abs(closing) < EPSILON or gap / closing < 0:
            return False
        return holds(gap / closing)

    return test


def _ahead(scene: Scene, body: Body, other: Body | Pose, how: tuple[str, str, bool], node: XmlNode) -> float:
    """A distance that is negative where the other lies behind, or beside."""
    gap = apart(scene, body, other, how, node)
    if how[0] not in STRAIGHT:
        return gap
    return gap if apart(scene, body, other, ("longitudinal", "entity", False), node) > BESIDE_M else -gap


def _closing(body: Body, other: Body | Pose) -> float:
    if not isinstance(other, Body) or abs(other.speed_mps) < EPSILON:
        return body.speed_mps
    assert body.pose is not None  # noqa: S101 - the distance was told before
    assert other.pose is not None  # noqa: S101 - as above
    turn = body.pose.heading_rad - other.pose.heading_rad
    along = body.speed_mps * math.cos(turn) * math.copysign(1.0, other.speed_mps)
    return math.copysign(1.0, along) * (along - abs(other.speed_mps))


@BY_ENTITY.plays("CollisionCondition")
def _collision(node: XmlNode) -> OfEntity:
    by_type = node.find("ByType")
    if by_type:
        kind = _TYPES[by_type.choice("type", _TYPES)]
        return lambda scene, name: any(
            _touch(scene, name, b.name, node) for b in scene.bodies.values() if b.kind == kind
        )
    other = node.need("EntityRef").text("entityRef")
    return lambda scene, name: any(_touch(scene, name, member, node) for member in scene.members(other, node))


def _touch(scene: Scene, name: str, other: str, node: XmlNode) -> bool:
    first, second = scene.body(name, node), scene.body(other, node)
    if first is second or not (first.present and second.present) or first.tow is second or second.tow is first:
        return False
    if first.pose is None or second.pose is None:
        return False
    reach = (first.box.length_m + first.box.width_m + second.box.length_m + second.box.width_m) / 2
    if math.dist(first.center()[:2], second.center()[:2]) > reach:
        return False
    return overlap(box_of(first), box_of(second))


@BY_ENTITY.plays("RelativeClearanceCondition", remark="by origins, or by boxes in free space, in the lanes named")
def _clearance(node: XmlNode) -> OfEntity:
    """Whether the lanes beside or around an entity are free of others over a stretch ahead and behind."""
    ahead, behind = node.number("distanceForward", 0.0), node.number("distanceBackward", 0.0)
    free, opposite = node.flag("freeSpace"), node.flag("oppositeLanes")
    spans = [(r.whole("from", -99), r.whole("to", 99)) for r in node.children("RelativeLaneRange")] or [(-99, 99)]
    names = [r.text("entityRef") for r in node.children("EntityRef")]

    def others(scene: Scene, name: str) -> Iterator[Body]:
        return (b for b in scene.bodies.values() if b.present and b.name != name and (not names or b.name in names))

    def test(scene: Scene, name: str) -> bool:
        body = scene.body(name, node)
        if (place := scene.lane_place(body)) is None:
            return True
        sense = scene.sense(body, place)
        for other in others(scene, name):
            there = scene.lane_place(other)
            if there is None or (not opposite and there.lane * place.lane < 0):
                continue
            gap = apart(scene, body, other, ("longitudinal", "road", free), node)
            aside = (there.lane - place.lane) * sense
            if -behind <= gap <= ahead and any(low <= aside <= high for low, high in spans):
                return False
        return True

    return test
