"""Controller actions. A controller belongs to the simulator: here entities move as the file states without it.

So that nothing is silent, each one that is switched on leaves a note beside the result.
"""

from __future__ import annotations

from sgcad_core.formats.openscenario.actions.running import PRIVATE, ActionStart, at_once
from sgcad_core.formats.openscenario.reading.elements import XmlNode

_ALONE = "controllers are the simulator's own: the entity moves as the file says without one"


@PRIVATE.plays("ActivateControllerAction", remark=f"{_ALONE} (noted)")
def _activate(node: XmlNode) -> ActionStart:
    if any(node.has(domain) and node.flag(domain) for domain in ("lateral", "longitudinal")):
        node.note(_ALONE, node.text("controllerRef", ""))
    return lambda scene, actor: at_once(scene.body(actor, node))


@PRIVATE.plays("ControllerAction", remark=f"{_ALONE} (noted)")
def _controller(node: XmlNode) -> ActionStart:
    """Assigning is no motion yet; activating and overriding pedals is what the controller would do."""
    parts = node.children()
    if not parts:
        raise node.fault("needs an <AssignControllerAction>, <OverrideControllerValueAction> or both")
    for part in parts:
        _part(part)
    return lambda scene, actor: at_once(scene.body(actor, node))


def _part(part: XmlNode) -> None:
    if part.tag == "ActivateControllerAction":
        _activate(part)
    elif part.tag == "OverrideControllerValueAction":
        if any(c.has("active") and c.flag("active") for c in part.children()):
            part.note("pedals, gears and steering wheels have no effect: speeds and paths are told directly")
    elif part.tag == "AssignControllerAction":
        if part.has("activateLateral") and part.flag("activateLateral"):
            part.note(_ALONE)
    else:
        raise part.unsupported()
