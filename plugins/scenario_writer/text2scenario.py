"""The further levels of a hierarchical reading: roles and temporal events, parsed by the model, placed by templates.

The model fills in a form (the actors with their origins, the events in order); rule templates make maneuvers, sides of
contact and places on the map of it, and the planner drives. The model never names a road, a lane line or a coordinate.
Knows no map library: any network will do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from plugins.scenario_writer._planned import PlannedWriter, roads_of
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Passage, Query, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.findings import FindingFactory
from sgcad_core.interfaces import Ask
from sgcad_core.kinds import DRIVEWAY, RAMP, actor_kind
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.motion.motion_record import Access
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.specs import (
    Actor,
    ActorId,
    ActorKind,
    Area,
    Compass,
    Contact,
    Light,
    Maneuver,
    Spec,
    SpeedMph,
    Surface,
    Weather,
)
from sgcad_core.roads.describe import describe_network

_finding = FindingFactory("scenario")

Action = Literal[
    "straight", "turn_left", "turn_right", "u_turn", "stopped", "parked", "slowing", "negotiating_curve",
    "lane_change_left", "lane_change_right", "merge", "overtaking", "crossing_centerline",
    "departing_road_left", "departing_road_right", "backing", "other", "strikes",
]  # fmt: skip
"""What an actor does in an event: a maneuver, or the contact itself."""
_SAME, _OPPOSITE = math.radians(45), math.radians(135)


class Role(Spec):
    """An actor and how it comes to the scene."""

    id: ActorId
    kind: ActorKind
    heading: Compass | None = Field(description="direction in which it travels before any turn")
    lane: Annotated[int, Field(ge=1, le=8)] | None = Field(None, description="1 = at the right curb")
    speed_mph: SpeedMph | None = None
    comes_from: Literal["road", "driveway", "ramp"] = "road"


class SceneEvent(Spec):
    """One thing that happens; the list's order is the order in time."""

    actor: ActorId
    action: Action
    target: ActorId | None = Field(None, description="strikes: the one that is struck")
    actor_area: Area | None = None
    target_area: Area | None = None


class Representation(Spec):
    """Roles and events, the levels above the scene's layout."""

    roles: Annotated[tuple[Role, ...], Field(min_length=1, max_length=12)]
    events: Annotated[tuple[SceneEvent, ...], Field(max_length=24)] = ()
    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None


class Text2Scenario(PlannedWriter):
    """Asks a model for roles and events; rule templates and the planner make the scenario from them."""

    asks_model: ClassVar[bool] = True
    prompt: str = Field("text2scenario_events", pattern=r"^[\w-]+$")
    """configs/prompts/<prompt>.md; its slot {roads} is filled."""

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt."""
        return (self.prompt,)

    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Asks, reads, fills the templates and plans. Raises InvalidOutput with findings, Refused."""
        spec = roads_of(network)
        query = Query(
            task=load_prompt(self.prompt, roads=describe_network(spec)),
            passages=tuple(passages),
            answer_schema=answer_schema(Representation),
            attempt=attempt,
        )
        parsed = parse_answer(ask(context, query).text, Representation)
        if faults := _faults(parsed):
            raise InvalidOutput("\n".join(f.line() for f in faults), faults)
        behavior = behavior_of_facts(facts_of(parsed), spec)
        taken = {actor.id for actor in behavior.actors}
        beside = [_beside(role, behavior.actors[0]) for role in parsed.roles if role.id not in taken]
        contacts = behavior.contacts or tuple(_contact(c) for c in _strikes(parsed))
        changed = {"actors": (*behavior.actors, *beside), "contacts": contacts}
        lost = context.reading.lost_control
        return compile_scenario(
            behavior.model_copy(update=changed), network, self.openscenario, self.encoding, may_skid=lost
        )


def _faults(parsed: Representation) -> list[Finding]:
    """Events of actors without a role, and contacts without a partner."""
    ids = [role.id for role in parsed.roles]
    found = []
    if not any(actor_kind(role.kind).drives for role in parsed.roles):
        found.append(_finding("no role drives", "roles", "", "give the vehicle of the crash a role"))
    for i, event in enumerate(parsed.events):
        if event.actor not in ids:
            found.append(_finding("no such role", f"events[{i}].actor", event.actor, f"one of {', '.join(ids)}"))
        if event.action == "strikes" and (event.target not in ids or event.target == event.actor):
            remedy = f"name another one of {', '.join(ids)}"
            found.append(_finding("strikes nobody", f"events[{i}].target", str(event.target), remedy))
    return found


# ------------------------------------------------------------------ templates
def facts_of(parsed: Representation) -> CrashFacts:
    """The parse in the form in which the project's rules place vehicles on a network."""
    driving = tuple(_vehicle(role, parsed) for role in parsed.roles if actor_kind(role.kind).drives)
    return CrashFacts(
        driving,
        contacts=_strikes(parsed),
        light=parsed.light,
        weather=parsed.weather,
        surface=parsed.surface,
        oriented=any(v.heading_stated for v in driving),
    )


def _vehicle(role: Role, parsed: Representation) -> VehicleFacts:
    done = _before_contact(role.id, parsed)
    origin: Access | None = DRIVEWAY if role.comes_from == DRIVEWAY else None
    if role.comes_from == RAMP:
        origin = RAMP
    return VehicleFacts(
        id=role.id, kind=role.kind, heading=role.heading, heading_stated=role.heading is not None,
        maneuver=done[-1] if done else "straight", maneuver_stated=bool(done), lane=role.lane,
        speed_mph=role.speed_mph or None, origin=origin,
        from_stop=len(done) > 1 and done[-2] == "stopped" and done[-1] not in ("stopped", "parked"),
    )  # fmt: skip


def _before_contact(actor: str, parsed: Representation) -> list[Maneuver]:
    """What an actor does up to the first contact of the crash, in order."""
    done: list[Maneuver] = []
    for event in parsed.events:
        if event.action == "strikes":
            break
        if event.actor == actor:
            done.append(event.action)
    return done


def _strikes(parsed: Representation) -> tuple[ContactFacts, ...]:
    roles = {role.id: role for role in parsed.roles}
    hits = [e for e in parsed.events if e.action == "strikes" and e.target is not None]
    return tuple(
        ContactFacts(
            e.actor, str(e.target), *_areas(e, roles[e.actor], roles[str(e.target)]), e.target_area is not None
        )
        for e in hits[:8]
    )


def _areas(event: SceneEvent, striker: Role, struck: Role) -> tuple[Area, Area]:
    """Sides as parsed; what is open is filled in by how the two headings stand to each other."""
    return event.actor_area or "front", event.target_area or _side(striker, struck)


def _side(striker: Role, struck: Role) -> Area:
    if actor_kind(struck.kind).thing or striker.heading is None or struck.heading is None:
        return "front" if actor_kind(struck.kind).thing else "back"
    across = math.remainder(angle_of(striker.heading) - angle_of(struck.heading), math.tau)
    if abs(across) <= _SAME:
        return "back"
    if abs(across) >= _OPPOSITE:
        return "front"
    return "right" if across > 0 else "left"  # a vehicle that heads to the left of the striker comes from its right


def _contact(c: ContactFacts) -> Contact:
    return Contact(striker=c.striker, struck=c.struck, striker_area=c.striker_area, struck_area=c.struck_area)


def _beside(role: Role, driver: Actor) -> Actor:
    """People and objects stand or cross where the first vehicle drives."""
    still = not (actor_kind(role.kind).drives or actor_kind(role.kind).walks)
    return Actor(
        id=role.id, kind=role.kind, road=driver.road, direction=driver.direction, speed_mph=role.speed_mph,
        maneuver="stopped" if still else "straight",
    )  # fmt: skip
