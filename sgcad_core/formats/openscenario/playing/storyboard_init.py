"""The Init of a storyboard: places and speeds of entities before the clock starts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from sgcad_core.formats.openscenario.actions import ActionStart, RunningAction, global_action, private_action
from sgcad_core.formats.openscenario.actions.running import GLOBAL, GlobalEffect, at_once
from sgcad_core.formats.openscenario.playing.body import place_trailers
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode

_PLACING = ("TeleportAction", "FollowTrajectoryAction", "AddEntityAction", "ConnectTrailerAction")


class _Move(NamedTuple):
    begin: ActionStart
    name: str
    node: XmlNode

    @property
    def teleports(self) -> bool:
        return self.node.only().tag in ("TeleportAction", "EntityAction")

    def ready(self, scene: Scene) -> bool:
        """Whether every entity that its position refers to has a place."""
        refs = [self.node.at(e).text("entityRef") for e in self.node.element.iterfind(".//Position//*[@entityRef]")]
        return all(scene.bodies[ref].pose is not None for ref in refs if ref in scene.bodies)


def initialize(board: XmlNode, scene: Scene) -> list[RunningAction]:
    """Run the Init actions; what is still under way comes back.

    Teleports come first, each when what it refers to has its place, whatever the order in the file.
    """
    node = board.need("Init")
    actions = node.need("Actions")
    for child in actions.children():
        if child.tag == "GlobalAction":
            if child.only().tag != "EntityAction":
                global_action(child)(scene)
        elif child.tag == "UserDefinedAction":
            GLOBAL.compile(child)(scene)
        elif child.tag != "Private":
            raise child.unsupported()
    moves = [*_moves(actions, scene), *_entities(actions)]
    _teleport([m for m in moves if m.teleports], scene)
    running = [m.begin(scene, m.name) for m in moves if not m.teleports]
    place_trailers(scene.bodies, anew=True)
    _check_places(board, node, scene)
    return [r for r in running if r.domains]


def _moves(actions: XmlNode, scene: Scene) -> Iterator[_Move]:
    for private in actions.children("Private"):
        names = scene.members(private.text("entityRef"), private)
        for action in private.children("PrivateAction"):
            begin = private_action(action)
            yield from (_Move(begin, name, action) for name in names)


def _entities(actions: XmlNode) -> Iterator[_Move]:
    """Entities that are added or taken away before the clock starts, in turn with those that are teleported."""
    for child in actions.children("GlobalAction"):
        if child.only().tag == "EntityAction":
            effect = global_action(child)

            def begin(scene: Scene, name: str, effect: GlobalEffect = effect) -> RunningAction:
                effect(scene)
                return at_once(scene.bodies[name])

            yield _Move(begin, child.only().text("entityRef"), child)


def _teleport(waiting: list[_Move], scene: Scene) -> None:
    while waiting:
        move = next((m for m in waiting if m.ready(scene)), waiting[0])  # none is: the first one says what it lacks
        waiting.remove(move)
        move.begin(scene, move.name)


def _check_places(board: XmlNode, blame: XmlNode, scene: Scene) -> None:
    """An entity without a place must get one later; it is absent until then."""
    for name, body in scene.bodies.items():
        if body.pose is None:
            if _placed_later(board, name):
                blame.note("entity is not there from the start", name, "it has no initial place in <Init>")
            else:
                blame.doubt("entity has no initial place", name, "add a <TeleportAction> for it to <Init>")
            body.present = False


def _placed_later(board: XmlNode, name: str) -> bool:
    for group in board.element.iterfind(".//ManeuverGroup"):
        if all(group.find(f".//{tag}") is None for tag in _PLACING):
            continue
        refs = [e.get("entityRef") for e in group.iterfind(".//*[@entityRef]")]
        if any(ref == name or ref.startswith("$") for ref in refs):
            return True
    return False
