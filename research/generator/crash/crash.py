"""The crash sampler: roads, a configuration that fits them, then numbers, lanes and speeds.

`configurations` knows striker and struck; a configuration that the roads do not allow is tried again.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from research.generator.crash import roads
from research.generator.crash.configurations import BUILDERS, opens
from research.generator.crash.world import Actor, Crash, Leg, pick
from sgcad_core.kinds import DRIVEWAY, FOUR, MERGE, PLAIN, T, actor_kind

CONFIGS = {
    "crossing": 15.0,
    "left_opposite": 15.0,
    "left_lateral": 10.0,
    "right_into": 4.0,
    "rear_end": 18.0,
    "head_on": 13.0,
    "lane_change": 6.0,
    "departure": 6.0,
    "pedestrian": 2.0,
    "parked": 2.5,
    "u_turn": 2.0,
    "backing": 1.5,
    "merge": 2.5,
    "overtaking": 2.5,
}
LAYOUTS = {
    "crossing": {FOUR: 9.0, T: 0.0},
    "left_opposite": {FOUR: 5.0, T: 2.5, DRIVEWAY: 1.5},
    "left_lateral": {FOUR: 2.5, T: 4.0, DRIVEWAY: 2.5},
    "right_into": {FOUR: 2.0, T: 3.0, DRIVEWAY: 2.0},
    "rear_end": {PLAIN: 4.5, FOUR: 3.5, T: 2.0, DRIVEWAY: 1.0},
    "backing": {DRIVEWAY: 1.0},
    "pedestrian": {PLAIN: 2.0, FOUR: 2.0, T: 1.0},
    "merge": {MERGE: 1.0},
    "u_turn": {PLAIN: 3.0, T: 1.0, FOUR: 1.0},
    "lane_change": {PLAIN: 5.0, FOUR: 1.5, T: 1.5},
    "overtaking": {PLAIN: 2.0, DRIVEWAY: 1.0, T: 1.0},
    "head_on": {PLAIN: 6.5, T: 1.5, FOUR: 1.0},
}
GLANCED = 0.2
"""Share of head-on crashes struck by the one who crossed whose other vehicle is hit on its side."""
WALKS = 0.05
"""Share of drawings that train, beside those that come up, of crashes with somebody on foot or on a bicycle."""
SELDOM = 0.2
"""Share of drawings that train in which a vehicle is a motorcycle, truck or bus instead of what it was."""
FAMILY_ODDS = {"rural": 0.42, "urban": 0.46, "highway": 0.12}


def sample_crash(rng: Random, config: str | None = None) -> Crash:
    """One crash, if named of one configuration; tries until roads and configuration fit (a few attempts at most)."""
    while True:
        crash = _roads(rng, config or pick(rng, CONFIGS))
        if BUILDERS[crash.config](rng, crash) and _sound(crash):
            _finish(rng, crash)
            return crash


def _roads(rng: Random, config: str) -> Crash:
    layout = pick(rng, LAYOUTS.get(config, {PLAIN: 1.0}))
    area = "highway" if layout == MERGE else pick(rng, FAMILY_ODDS)
    if layout != PLAIN and area == "highway" and layout != MERGE:
        area = "urban"
    main = rng.choice((0, 2, 4, 6)) if rng.random() < 0.9 else rng.choice((1, 3, 5, 7))
    least = 2 if config == "lane_change" else 1
    if layout == PLAIN:
        legs = sorted(roads.pair(rng, main, area, least, rng.random() < 0.05), key=lambda leg: leg.bearing)
        if rng.random() < (0.5 if config in ("head_on", "departure") else 0.15):
            roads.curve(rng, legs)
    else:
        legs = roads.merge(rng, main) if layout == MERGE else roads.junction(rng, layout, main, area)
    light, weather, surface = conditions(rng)
    return Crash(config, layout, main % 8, legs, [], [], light, weather, surface, roads.accesses(rng, legs), area)


def with_glancing_sides(rng: Random, crash: Crash) -> Crash:
    """Now and then one that crosses the center line meets the side of the oncoming vehicle instead of its front."""
    first = crash.contacts[0]
    ends = first.striker_area == first.struck_area == "front"
    crossed = crash.config == "head_on" and crash.actors[first.striker].maneuver == "crossing_centerline"
    if not (ends and crossed) or rng.random() > GLANCED:
        return crash
    return replace(crash, contacts=[replace(first, struck_area="left"), *crash.contacts[1:]])


def with_rare_actor(rng: Random, crash: Crash) -> Crash:
    """The crash with rare actors more often than on roads, as far as a drawing can show them: pedestrians, bicycles,
    vehicles of rare kinds."""
    if rng.random() < WALKS:
        crash = sample_crash(rng, "pedestrian")
    vehicles = [i for i, actor in enumerate(crash.actors) if actor.vehicle]
    if vehicles and rng.random() < SELDOM:
        i, kind = rng.choice(vehicles), rng.choice(("motorcycle", "truck", "bus"))
        actors = [replace(actor, kind=kind) if at == i else actor for at, actor in enumerate(crash.actors)]
        return replace(crash, actors=actors)
    return crash


def conditions(rng: Random) -> tuple[str, str, str]:
    """Light, weather and a surface that goes with it."""
    light = pick(rng, {"day": 70.0, "dark": 12.0, "dark_lit": 11.0, "dusk": 4.0, "dawn": 3.0})
    weather = pick(rng, {"clear": 66.0, "cloudy": 14.0, "rain": 13.0, "snow": 4.0, "sleet": 1.0, "fog": 2.0})
    wet = {
        "rain": {"wet": 1.0},
        "snow": {"snow": 6.0, "ice": 2.0, "wet": 2.0},
        "sleet": {"ice": 2.0, "wet": 2.0},
        "fog": {"dry": 2.0, "wet": 1.0},
    }
    return light, weather, pick(rng, wet.get(weather, {"dry": 91.0, "wet": 6.0, "ice": 3.0}))


# ------------------------------------------------------------------ finish
def _sound(crash: Crash) -> bool:
    """Every actor starts on a lane and has one to go to (walkers and objects need none)."""
    for actor in crash.actors:
        leg = crash.leg(actor.leg)
        if leg is None:
            return False
        wheels = actor_kind(actor.kind).motor
        if wheels and (not leg.lanes_in or (actor.out is not None and not opens(crash, actor.out))):
            return False
    return True


def _finish(rng: Random, crash: Crash) -> None:
    """Numbers, lanes and speeds."""
    order = list(range(len(crash.actors)))
    vehicles = [i for i in order if actor_kind(crash.actors[i].kind).motor]
    if len(vehicles) > 1 and rng.random() < 0.5:
        vehicles[0], vehicles[1] = vehicles[1], vehicles[0]
    rest = [i for i in order if i not in vehicles]
    order = vehicles + rest
    for number, i in enumerate(vehicles, 1):
        crash.actors[i].id = f"V{number}"
    for i in rest:
        crash.actors[i].id = f"{actor_kind(crash.actors[i].kind).letter}1"
    place = {old: new for new, old in enumerate(order)}
    crash.actors = [crash.actors[i] for i in order]
    for contact in crash.contacts:
        contact.striker, contact.struck = place[contact.striker], place[contact.struck]
    for actor in crash.actors:
        _lane_and_speed(rng, crash, actor)
    for i in range(1, len(crash.actors)):
        _same_lane(crash, crash.actors[0], crash.actors[i])
    for actor in crash.actors:  # who goes on along a bend negotiates it, whatever else happens there
        if actor.maneuver == "straight" and actor.vehicle and crash.leg(actor.leg).curve != "none":  # type: ignore[union-attr]
            actor.maneuver = "negotiating_curve"


def _lane_and_speed(rng: Random, crash: Crash, actor: Actor) -> None:
    leg: Leg = crash.leg(actor.leg)  # type: ignore[assignment]
    if actor_kind(actor.kind).laneless:
        return
    actor.lane = lane_for(rng, leg, actor)
    if actor.maneuver in ("stopped", "parked"):
        actor.speed = 0
    elif actor_kind(actor.kind).motor:
        limit = leg.limit or 35
        slow = (
            actor.maneuver.startswith("turn")
            or actor.maneuver in ("u_turn", "backing", "slowing")
            or leg.kind == DRIVEWAY
        )
        actor.speed = (
            rng.choice((5, 5, 5, 5, 10, 15, 20))
            if slow
            else max(10, min(80, limit + rng.choice((-15, -10, -5, 0, 0, 0, 5, 10))))
        )


def lane_for(rng: Random, leg: Leg, actor: Actor) -> int:
    """A lane that allows what the actor means to do; 1 is at the right curb."""
    turn = {2: "left", 6: "right", 4: "through"}.get(
        ((actor.out if actor.out is not None else actor.leg + 4) - actor.leg) % 8, "through"
    )
    fits = [i for i, use in enumerate(leg.turns_in, 1) if turn in use]
    lanes = max(leg.lanes_in, 1)
    if actor.maneuver == "lane_change_left":
        return rng.randint(1, lanes - 1)
    if actor.maneuver == "lane_change_right":
        return rng.randint(2, lanes)
    if fits:
        return rng.choice(fits)
    if turn == "left" or actor.maneuver in ("u_turn", "crossing_centerline", "overtaking"):
        return lanes
    if turn == "right" or actor.maneuver in ("parked", "departing_road_right"):
        return 1
    return rng.randint(1, lanes)


def _same_lane(crash: Crash, first: Actor, other: Actor) -> None:
    """Those that meet in one lane or in neighboring lanes of one road."""
    if crash.config == "rear_end":
        lead = crash.actors[crash.contacts[0].struck]
        other.lane = first.lane = lead.lane
    if crash.config == "lane_change":
        changer, straight = (first, other) if first.maneuver.startswith("lane_change") else (other, first)
        straight.lane = changer.lane + (1 if changer.maneuver.endswith("left") else -1)  # type: ignore[operator]
    if crash.config == "merge":
        (first if crash.is_main(first.leg) else other).lane = 1
    if crash.config == "overtaking" and first.leg == other.leg:
        other.lane = first.lane
