"""Actions that put entities somewhere, take them away or change how they look."""

from __future__ import annotations

from sgcad_core.formats.openscenario.actions.running import GLOBAL, PRIVATE, Begin, Effect, Running, at_once
from sgcad_core.formats.openscenario.playing.positions import position
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import Node


@PRIVATE.plays("TeleportAction")
def _teleport(node: Node) -> Begin:
    where = position(node.need("Position"))

    def begin(scene: Scene, actor: str) -> Running:
        body, spot = scene.body(actor, node), where(scene)
        body.put(spot.pose, spot.place)
        body.owners.pop("path", None)
        return at_once(body)

    return begin


@PRIVATE.plays("VisibilityAction", "AppearanceAction", remark="changes no motion")
def _seen(node: Node) -> Begin:
    return lambda scene, actor: at_once(scene.body(actor, node))


@PRIVATE.plays("TrailerAction", remark="a trailer rolls behind the hitch of what pulls it")
def _trailer(node: Node) -> Begin:
    child = node.only()
    if child.tag not in ("ConnectTrailerAction", "DisconnectTrailerAction"):
        raise child.unsupported()
    trailer = child.text("trailerRef", "") if child.tag == "ConnectTrailerAction" else ""

    def begin(scene: Scene, actor: str) -> Running:
        body = scene.body(actor, node)
        for other in scene.bodies.values():
            if other.tow is body:
                other.tow, other.speed_mps = None, body.speed_mps
        if trailer:
            scene.body(trailer, child).tow = body
        return at_once(body)

    return begin


@GLOBAL.plays("EntityAction", remark="an entity that is taken away keeps its last place in the trajectories")
def _entity(node: Node) -> Effect:
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
