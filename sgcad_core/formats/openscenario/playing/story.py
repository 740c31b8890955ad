"""The storyboard while it is played: acts, maneuver groups, maneuvers and events with their states.

Each step first ends what is over, then starts and stops what is triggered: what ends by itself at a step is seen by
conditions from the next step on, as players have it. Knows no action's or condition's meaning.
"""

from __future__ import annotations

from sgcad_core.formats.openscenario.actions import (
    ActionStart,
    GlobalEffect,
    RunningAction,
    global_action,
    private_action,
)
from sgcad_core.formats.openscenario.actions.running import GLOBAL
from sgcad_core.formats.openscenario.conditions import Trigger
from sgcad_core.formats.openscenario.playing.scene import ElementState, Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode

_PRIORITIES = ("override", "overwrite", "parallel", "skip")


class Event:
    """Runs its actions for every actor of its group each time its trigger fires, up to its count."""

    def __init__(self, node: XmlNode, path: str, actors: list[str], select: bool, scene: Scene) -> None:
        self.stage, self.actors, self._select = _stage("event", path, scene), actors, select
        self.priority = node.choice("priority", _PRIORITIES) if node.has("priority") else "override"
        self._count = self.left = _count(node)
        self.trigger = Trigger(node.find("StartTrigger"), missing=True)
        self.actions = [_action(a, f"{path}::{a.name}", scene) for a in node.children("Action")]
        if not self.actions:
            raise node.fault("has no action", remedy="give it an <Action>")
        if not actors and not select and any(begin for begin, _, _ in self.actions):
            raise node.fault("a private action needs an actor", remedy="name one in the ManeuverGroup's <Actors>")
        self.running: list[tuple[RunningAction, ElementState]] = []

    @property
    def is_running(self) -> bool:
        """Whether its actions are under way."""
        return self.stage.state == "runningState"

    def wants_to_start(self, scene: Scene) -> bool:
        """Whether its trigger fires now (evaluated in standby only)."""
        return self.stage.state == "standbyState" and self.trigger.fires(scene)

    def start(self, scene: Scene) -> None:
        """ActionStart every action."""
        self.left -= 1
        self.stage.turn("startTransition", "runningState", scene.step)
        self.running = []
        actors = list(dict.fromkeys((*self.actors, *self.trigger.entities))) if self._select else self.actors
        for begin, effect, stage in self.actions:
            stage.turn("startTransition", "runningState", scene.step)
            if effect:
                effect(scene)
            self.running += [(begin(scene, actor), stage) for actor in actors] if begin else []

    def stop(self, scene: Scene) -> None:
        """End it before its actions have ended."""
        for running, _ in self.running:
            running.stop()
        self._end("stopTransition", scene, again=False)

    def skip(self, scene: Scene) -> None:
        """Its trigger fired while another event of the maneuver ran."""
        self.left -= 1
        state = "standbyState" if self.left > 0 else "completeState"
        self.stage.turn("skipTransition", state, scene.step)

    def settle(self, scene: Scene) -> None:
        """Complete it when all of its actions have ended."""
        if not self.is_running:
            return
        going = [(r, s) for r, s in self.running if not r.done(scene)]
        for _, _, stage in self.actions:
            if stage.state == "runningState" and not any(s is stage for _, s in going):
                stage.turn("endTransition", "completeState", scene.step)
        self.running = going
        if not going:
            self._end("endTransition", scene, again=self.left > 0)

    def reset(self) -> None:
        """Stand by for another run of its group."""
        self.left, self.running, self.stage.state = self._count, [], "standbyState"
        self.trigger.reset()

    def _end(self, transition: str, scene: Scene, again: bool) -> None:
        self.running = []
        self.stage.turn(transition, "standbyState" if again else "completeState", scene.step)
        if again:
            self.trigger.reset()


class Maneuver:
    """Events that know each other by priority."""

    def __init__(self, node: XmlNode, path: str, actors: list[str], select: bool, scene: Scene) -> None:
        node = node.scoped()
        self.stage = _stage("maneuver", path, scene)
        events = node.children("Event")
        self.events = [Event(e, f"{path}::{e.name}", actors, select, scene) for e in events]

    @property
    def complete(self) -> bool:
        """Whether every event is."""
        return all(e.stage.state == "completeState" for e in self.events)

    def settle(self, scene: Scene) -> None:
        """End what is over."""
        for event in self.events:
            event.settle(scene)
        if self.complete and self.stage.state == "runningState":
            self.stage.turn("endTransition", "completeState", scene.step)

    def step(self, scene: Scene) -> None:
        """Start what is triggered."""
        if self.stage.state == "standbyState":
            self.stage.turn("startTransition", "runningState", scene.step)
        for event in self.events:
            if event.wants_to_start(scene):
                self._start(event, scene)

    def _start(self, event: Event, scene: Scene) -> None:
        others = [e for e in self.events if e.is_running]
        if others and event.priority == "skip":
            event.skip(scene)
            return
        for other in others if event.priority in ("override", "overwrite") else []:
            other.stop(scene)
        event.start(scene)

    def stop(self, scene: Scene) -> None:
        """End it and its events."""
        for event in self.events:
            if event.stage.state != "completeState":
                event.stop(scene)
        self.stage.turn("stopTransition", "completeState", scene.step)

    def reset(self) -> None:
        """Stand by for another run of its group."""
        self.stage.state = "standbyState"
        for event in self.events:
            event.reset()


class Group:
    """A maneuver group: maneuvers for the same actors, run as often as it says."""

    def __init__(self, node: XmlNode, path: str, scene: Scene) -> None:
        self.left = _count(node)
        holder = node.need("Actors")
        select = holder.flag("selectTriggeringEntities", False)
        refs = holder.children("EntityRef")
        actors = [name for ref in refs for name in scene.members(ref.text("entityRef"), holder)]
        self.stage = _stage("maneuverGroup", path, scene)
        found = [m.followed("Maneuver") for m in node.children("CatalogReference", "Maneuver")]
        self.maneuvers = [Maneuver(m, f"{path}::{m.name}", actors, select, scene) for m in found]

    def settle(self, scene: Scene) -> None:
        """End what is over; stand by again while there are executions left."""
        for maneuver in self.maneuvers:
            maneuver.settle(scene)
        if self.stage.state == "runningState" and all(m.complete for m in self.maneuvers):
            self.left -= 1
            self.stage.turn("endTransition", "completeState" if self.left < 1 else "runningState", scene.step)
            for maneuver in self.maneuvers if self.left > 0 else ():
                maneuver.reset()

    @property
    def complete(self) -> bool:
        """Whether it has run as often as it may."""
        return self.stage.state == "completeState"


class Act:
    """Groups that start together."""

    def __init__(self, node: XmlNode, path: str, scene: Scene) -> None:
        self.stage = _stage("act", path, scene)
        self.start_trigger = Trigger(node.find("StartTrigger"), missing=True)
        self.stop_trigger = Trigger(node.find("StopTrigger"), missing=False)
        self.groups = [Group(g, f"{path}::{g.name}", scene) for g in node.children("ManeuverGroup")]

    @property
    def complete(self) -> bool:
        """Whether it is over."""
        return self.stage.state == "completeState"

    def settle(self, scene: Scene) -> None:
        """End what is over."""
        if self.stage.state != "runningState":
            return
        for group in self.groups:
            group.settle(scene)
        if all(g.complete for g in self.groups):
            self.stage.turn("endTransition", "completeState", scene.step)

    def step(self, scene: Scene) -> None:
        """Start it, stop it, start what is triggered in it."""
        if self.stage.state == "standbyState" and self.start_trigger.fires(scene):
            self._turn_all("startTransition", "runningState", scene)
        if self.stage.state != "runningState":
            return
        if self.stop_trigger.fires(scene):
            self._stop(scene)
            return
        for group in self.groups:
            for maneuver in group.maneuvers if not group.complete else ():
                maneuver.step(scene)

    def _stop(self, scene: Scene) -> None:
        for group in self.groups:
            for maneuver in group.maneuvers:
                maneuver.stop(scene)
        self._turn_all("stopTransition", "completeState", scene)

    def _turn_all(self, transition: str, state: str, scene: Scene) -> None:
        for stage in (self.stage, *(g.stage for g in self.groups)):
            stage.turn(transition, state, scene.step)


class Storyboard:
    """All stories and the trigger that ends the scenario; `init`: actions of Init that are still under way."""

    def __init__(self, node: XmlNode, scene: Scene, init: list[RunningAction]) -> None:
        self.init = init
        self.stop_trigger = Trigger(node.find("StopTrigger"), missing=False)
        self.stories: list[tuple[ElementState, list[Act]]] = []
        for story in node.children("Story"):
            scoped, name = story.scoped(), story.name
            acts = [Act(a, f"{name}::{a.name}", scene) for a in scoped.children("Act")]
            stage = _stage("story", name, scene)
            stage.turn("startTransition", "runningState", 0)
            self.stories.append((stage, acts))

    def step(self, scene: Scene) -> float | None:
        """Play one step; the time at which the scenario ended, or None.

        Only the stop trigger ends it; without one it ends when all of its stories are complete.
        """
        self.init = [running for running in self.init if not running.done(scene)]
        acts = [act for _, acts in self.stories for act in acts]
        for act in acts:
            act.settle(scene)
        for act in acts:
            act.step(scene)
        for stage, inner in self.stories:
            if stage.state == "runningState" and all(a.complete for a in inner):
                stage.turn("endTransition", "completeState", scene.step)
        if self.stop_trigger:
            return self.stop_trigger.moment(scene)
        return scene.t_s if all(s.state == "completeState" for s, _ in self.stories) else None

    def close(self) -> None:
        """Note which edges never came, so that a reader knows why something did not start."""
        acts = [act for _, acts in self.stories for act in acts]
        events = [e for act in acts for group in act.groups for maneuver in group.maneuvers for e in maneuver.events]
        of_acts = [trigger for act in acts for trigger in (act.start_trigger, act.stop_trigger)]
        for trigger in (self.stop_trigger, *of_acts, *(event.trigger for event in events)):
            trigger.close()


def _stage(kind: str, path: str, scene: Scene) -> ElementState:
    stage = ElementState(kind, path)
    scene.stages.append(stage)
    return stage


def _count(node: XmlNode) -> int:
    count = node.number("maximumExecutionCount", 1)
    if count < 0 or count != int(count):
        raise node.fault("attribute 'maximumExecutionCount' is no count", f"{count:g}")
    return int(count)


def _action(node: XmlNode, path: str, scene: Scene) -> tuple[ActionStart | None, GlobalEffect | None, ElementState]:
    stage = _stage("action", path, scene)
    if not node.children():
        node.doubt("needs exactly one child element", "0", "nothing happens")
        return None, None, stage
    child = node.only()
    if child.tag == "PrivateAction":
        return private_action(child), None, stage
    return None, global_action(child) if child.tag == "GlobalAction" else GLOBAL.compile(child), stage
