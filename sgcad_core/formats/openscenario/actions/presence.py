"""Actions that place, remove and show entities."""

from __future__ import annotations

from sgcad_core.formats.openscenario.actions.running import (
    GLOBAL,
    PRIVATE,
    ActionStart,
    GlobalEffect,
    RunningAction,
    at_once,
)
from sgcad_core.formats.openscenario.playing.positions import position
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode


@PRIVATE.plays("TeleportAction")
def _teleport(node: XmlNode) -> ActionStart:
    where = position(node.need("Position"))

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, spot = scene.body(actor, node), where(scene)
        body.put(spot.pose, spot.place)
        body.owners.pop("path", None)
        return at_once(body)

    return begin


@PRIVATE.plays("VisibilityAction", "AppearanceAction", remark="changes no motion")
def _seen(node: XmlNode) -> ActionStart:
    return lambda scene, actor: at_once(scene.body(actor, node))


@PRIVATE.plays("TrailerAction", remark="a trailer rolls behind the hitch of what pulls it")
def _trailer(node: XmlNode) -> ActionStart:
    child = node.only()
    if child.tag not in ("ConnectTrailerAction", "DisconnectTrailerAction"):
        raise child.unsupported()
    trailer = child.text("trailerRef", "") if child.tag == "ConnectTrailerAction" else ""

    def begin(scene: Scene, actor: str) -> RunningAction:
        body = scene.body(actor, node)
        for other in scene.bodies.values():
            if other.tow is body:
                other.tow, other.speed_mps = None, body.speed_mps
        if trailer:
            scene.body(trailer, child).tow = body
        return at_once(body)

    return begin


@GLOBAL.plays("EntityAction", remark="an entity that is taken away keeps its last place in the trajectories")
def _entity(node: XmlNode) -> GlobalEffect:
    name, child = node.text("entityRef"), node.only()
    if child.tag == "DeleteEntityAction":
        return lambda scene: setattr(scene.body(name, node), "present", False)
    if child.tag != "AddEntityAction":
        raise child.unsupported()
    where = position(child.need("Position"))

    def add(scene: Scene) -> None:
        spot = where(scene)
        scene.body(name, node).put(spot.pose, spot.place)

    return add
