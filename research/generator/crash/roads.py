"""Roads around a hub: how many legs, how many lanes, which control, with the frequencies of U.S. reports.

Makes the legs only; `crash` decides which actors drive on them.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from research.generator.crash.world import OPPOSITE, TURN_OF, Access, Actor, Crash, Leg, pick
from research.model.answer_grammar import MAX_ACCESSES
from sgcad_core.kinds import DRIVEWAY, FOUR, INTERSECTIONS, MERGE, PLAIN, RAMP, ROAD

LIMITS = {
    "rural": (35, 40, 45, 45, 50, 55, 55, 55),
    "urban": (25, 25, 30, 30, 35, 35, 40, 45),
    "highway": (55, 60, 65, 65, 70),
}
MEDIANS = {"grass": 3.0, "barrier": 3.0, "raised": 3.0, "painted": 1.5}


def main_road(rng: Random, area: str, least: int = 1) -> tuple[int, int, str, bool]:
    """Lanes one way, lanes the other way, median and two-way left-turn lane of a through road."""
    weights = (
        {"1": 66.0, "2": 24.0, "3": 7.0, "4": 2.0} if area != "highway" else {"1": 5.0, "2": 55.0, "3": 25.0, "4": 12.0}
    )
    one = max(least, int(pick(rng, weights)))
    other = one
    if rng.random() < 0.08:
        other = max(1, one + rng.choice((-1, 1)))
    twltl = area == "urban" and one + other >= 2 and rng.random() < (0.2 if one + other >= 4 else 0.07)
    divided = not twltl and one + other >= 4 and rng.random() < (0.9 if area == "highway" else 0.4)
    median = pick(rng, MEDIANS) if divided else ("painted" if one > 1 and rng.random() < 0.05 and not twltl else "none")
    return one, other, median, twltl


def pair(rng: Random, bearing: int, area: str, least: int = 1, one_way: bool = False) -> list[Leg]:
    """Both legs of a through road: traffic out of one goes into the other."""
    to, fro, median, twltl = main_road(rng, area, least)
    limit = rng.choice(LIMITS[area])
    if one_way:
        to, fro, median, twltl = max(to, rng.choice((1, 1, 2, 2, 3))), 0, "none", False
    first = Leg(bearing % 8, to, fro, median=median, twltl=twltl, limit=limit)
    second = Leg((bearing + 4) % 8, fro, to, median=median, twltl=twltl, limit=limit)
    if one_way and rng.random() < 0.5:
        first.lanes_in, first.lanes_out, second.lanes_in, second.lanes_out = 0, to, to, 0
    return [first, second]


def curve(rng: Random, legs: list[Leg]) -> None:
    """Bend a plain road: what is a left curve one way is a right curve the other way."""
    side = rng.choice(("left", "right"))
    other = OPPOSITE[side]
    legs[0].curve, legs[1].curve = side, other


def add_turn_lanes(rng: Random, legs: list[Leg], bearings: set[int], odds: float) -> None:
    """Widen approaches by turn lanes and say what each lane is for."""
    chosen = {leg.bearing % 4 for leg in legs if rng.random() < odds}
    if len(chosen) == 1 and rng.random() < 0.4:
        chosen = {leg.bearing % 4 for leg in legs}
    for leg in legs:
        if leg.bearing % 4 not in chosen or leg.kind != ROAD or not leg.lanes_in or leg.twltl:
            continue
        turns = [t for t, step in (("right", -2), ("through", 4), ("left", 2)) if (leg.bearing + step) % 8 in bearings]
        leg.turns_in = lane_uses(rng, turns, leg.lanes_in)
        leg.lanes_in = len(leg.turns_in) or leg.lanes_in


def lane_uses(rng: Random, turns: list[str], lanes: int) -> list[str]:
    """Use of each lane from the right curb; [] where no lane is for turning only."""
    if "through" not in turns:
        return ["right", "left"] if len(turns) == 2 and lanes <= 2 else []
    uses = ["through"] * lanes
    if "right" in turns:
        if rng.random() < 0.3:
            uses = ["right", *uses]
        else:
            uses[0] = "through_right"
    if "left" in turns and (rng.random() < 0.85 or uses[0] != "right"):
        uses = [*uses, "left"]
    return uses if {"left", "right"} & set(uses) else []


def control(rng: Random, legs: list[Leg], main: int) -> None:
    """Signal, signs or nothing, the same way for both legs of a road."""
    lanes = max(leg.lanes_in for leg in legs)
    drive = any(leg.kind == DRIVEWAY for leg in legs)
    weights = {
        "signal": 0.25 + 0.5 * (lanes > 1),
        "stop": 0.9 if lanes <= 2 else 0.4,
        "none": 0.35,
        "all": 0.08,
        "flashing": 0.04,
        "yield": 0.04,
    }
    if drive:
        weights = {"none": 0.9, "stop": 0.1}
    if len(legs) == 3:
        weights["signal"] = weights.get("signal", 0.0) * 0.4
    kind = pick(rng, weights)
    for leg in legs:
        minor = leg.bearing % 4 != main % 4
        if not leg.lanes_in:
            continue
        if kind in ("signal", "flashing") or (kind == "all"):
            leg.control = "stop" if kind == "all" else kind
        elif kind in ("stop", "yield") and minor:
            leg.control = kind


def junction(rng: Random, layout: str, main: int, area: str) -> list[Leg]:
    """Legs of a three-leg, four-leg or driveway junction, ordered clockwise from north."""
    one_way = layout == FOUR and rng.random() < 0.2
    legs = pair(rng, main, area, one_way=one_way and rng.random() < 0.6)
    if layout == FOUR:
        calm = "urban" if area == "urban" or rng.random() < 0.3 else "rural"
        side = pair(rng, main + 2, calm, one_way=one_way and rng.random() < 0.6)
        if sum(s.lanes_in for s in side) > sum(m.lanes_in for m in legs) and rng.random() < 0.7:
            for leg in side:
                leg.lanes_in, leg.lanes_out = min(leg.lanes_in, 1), min(leg.lanes_out, 1)
                leg.median, leg.twltl = "none", False
        legs += side
    else:
        legs.append(stem(rng, layout, main))
    bearings = {leg.bearing for leg in legs if leg.lanes_out}
    if layout != DRIVEWAY:
        add_turn_lanes(rng, legs, bearings, 0.22 if area == "rural" else 0.38)
    control(rng, legs, main)
    return sorted(legs, key=lambda leg: leg.bearing)


def stem(rng: Random, layout: str, main: int) -> Leg:
    """The third leg of a T: a side road or a driveway."""
    bearing = (main + rng.choice((2, -2))) % 8
    if layout == DRIVEWAY:
        return Leg(bearing, kind=DRIVEWAY)
    lanes = 2 if rng.random() < 0.1 else 1
    return Leg(bearing, lanes, lanes, limit=rng.choice(LIMITS["urban"]) if rng.random() < 0.5 else None)


def merge(rng: Random, main: int) -> list[Leg]:
    """A highway (one carriageway's direction matters) with an entrance ramp that leans to its approach leg."""
    legs = pair(rng, main, "highway", least=2)
    ramp = Leg((main + rng.choice((1, -1))) % 8, 1, 0, kind=RAMP)
    ramp.bearing = (main - 1) % 8
    return sorted([*legs, ramp], key=lambda leg: leg.bearing)


NEAR_JUNCTIONS = 0.25
"""Share of the drawings of junctions that show driveways, where there are some, although no text tells of them."""


def accesses(rng: Random, legs: list[Leg]) -> list[Access]:
    """Now and then a driveway or side road away from the hub."""
    if rng.random() > 0.07:
        return []
    leg = rng.choice([leg for leg in legs if leg.kind == ROAD])
    return [
        Access(
            leg.bearing,
            rng.choice(("left", "right")),
            rng.choice((30, 40, 40, 60)),
            rng.choice((DRIVEWAY, DRIVEWAY, ROAD)),
        )
    ]


def with_access_mouths(rng: Random, crash: Crash, told: bool) -> Crash:
    """The crash with driveways beside the one that matters, as along shops, each drawn no further than its mouth.

    Around junctions investigators rarely draw any: where no text tells of them (not `told`), most have none.
    """
    if crash.area_word == "highway":
        return crash
    bare = crash.layout in INTERSECTIONS and not told and rng.random() > NEAR_JUNCTIONS
    found = [] if bare else [replace(access, mouth=rng.uniform(1.5, 14.0)) for access in crash.accesses]
    free = [leg for leg in crash.legs if leg.kind == ROAD and all(leg.bearing != access.leg for access in found)]
    stem = next((leg.bearing for leg in crash.legs if leg.kind == DRIVEWAY), None)
    odds = 0.35 if found or stem is not None else 0.03
    while free and not bare and len(found) < MAX_ACCESSES and rng.random() < odds:
        leg = free.pop(rng.randrange(len(free)))
        side = rng.choice(("left", "right"))
        if stem is not None and rng.random() < 0.6:
            side = "right" if (leg.bearing - 2) % 8 == stem else "left"
        kind = rng.choice((DRIVEWAY, DRIVEWAY, DRIVEWAY, ROAD))
        found.append(Access(leg.bearing, side, rng.choice((20, 20, 30, 30, 40)), kind, rng.uniform(1.5, 14.0)))
    came = {actor.leg for actor in crash.actors}
    short = {leg.bearing for leg in crash.legs if leg.kind == DRIVEWAY and rng.random() < 0.5} - came
    legs = [replace(leg, mouth=rng.uniform(2.0, 6.0)) if leg.bearing in short else leg for leg in crash.legs]
    return replace(crash, legs=legs, accesses=found)


def one_carriageway(crash: Crash) -> Crash | None:
    """The crash on the one carriageway of a divided road that matters; None where both do, or none is divided."""
    found = next((i for i, leg in enumerate(crash.legs) if leg.bearing == crash.actors[0].leg), None)
    if crash.layout != PLAIN or crash.accesses or len(crash.legs) != 2 or found is None:
        return None
    here, there = crash.legs[found], crash.legs[1 - found]
    stays = all(a.leg == here.bearing and a.maneuver not in ("crossing_centerline", "u_turn") for a in crash.actors)
    if here.median not in ("grass", "barrier") or not stays or not here.lanes_in:
        return None
    legs = [
        replace(here, lanes_out=0, median="none", twltl=False),
        replace(there, lanes_in=0, turns_in=[], lanes_out=max(there.lanes_out, 1), median="none", twltl=False),
    ]
    return replace(crash, legs=legs if found == 0 else legs[::-1], one_way=True)


def beside(crash: Crash) -> Crash | None:
    """The same crash on a plain road, without the junction beside it; None where the junction matters."""
    main = [replace(leg, control="none") for leg in crash.legs if crash.is_main(leg.bearing)]
    ways = {leg.bearing for leg in main}
    used = {way for a in crash.actors for way in (a.leg, a.out) if way is not None}
    told = {a.purpose for a in crash.actors} & {"light", "sign"}
    if crash.layout not in INTERSECTIONS or len(main) != 2 or not used <= ways or told:
        return None
    return replace(crash, layout=PLAIN, legs=main)


def one_way(rng: Random, crash: Crash, odds: float) -> Crash:
    """The crash with, at these odds, a one-way street for a two-way one whose other direction no actor uses.

    A through road keeps both legs, the third leg of a T only leads in or only out. Most such streets have one lane; one
    that several came by keeps its lanes.
    """
    ways = _unused(crash)
    if rng.random() > odds or not ways:
        return crash
    into, out = rng.choice(ways)
    here = [actor for actor in crash.actors if actor.leg == into and actor.lane]
    lanes = max(rng.choice((1, 1, 1, 1, 2, 2, 3)), *(actor.lane or 1 for actor in here), 1)
    if len(here) > 1:
        lanes = next(leg.lanes_in for leg in crash.legs if leg.bearing == into)
    legs = []
    for leg in crash.legs:
        if leg.bearing == into:
            leg = Leg(into, lanes, 0, control=leg.control, curve=leg.curve, limit=leg.limit)
        elif leg.bearing == out:
            leg = Leg(out, 0, lanes, curve=leg.curve, limit=leg.limit)
        else:
            leg = replace(leg, turns_in=_uses(leg, into))
        legs.append(leg)
    actors = [replace(a, lane=_lane_of(a, lanes)) if here == [a] else a for a in crash.actors]
    return replace(crash, legs=legs, actors=actors)


def _unused(crash: Crash) -> list[tuple[int, int]]:
    """Directions in which a road of the crash may become one-way: bearings that traffic comes from and goes to.

    No lane of another road may be only for a turn that would be closed.
    """
    swerves = any(a.maneuver in ("crossing_centerline", "overtaking", "u_turn", "backing") for a in crash.actors)
    if swerves or crash.layout == MERGE or crash.area_word == "highway":
        return []
    wheels = [a for a in crash.actors if a.vehicle]
    came, left = {a.leg for a in wheels}, {a.out for a in wheels}
    only = {(leg.bearing + TURN_OF[use]) % 8 for leg in crash.legs for use in leg.turns_in if use in TURN_OF}
    axes = {leg.bearing % 4 for leg in crash.legs if leg.kind == ROAD and leg.two_way}
    axes -= {leg.bearing % 4 for leg in crash.legs if leg.kind != ROAD}
    ways = [(axis + step, (axis + 4 - step) % 8) for axis in sorted(axes) for step in (0, 4)]
    return [(into, out) for into, out in ways if into not in left | only and out not in came]


def _uses(leg: Leg, closed: int) -> list[str]:
    """Uses of a leg's lanes where one leg can no longer be driven into; [] where no lane is left for turning only."""
    kept = [[way for way in use.split("_") if (leg.bearing + TURN_OF[way]) % 8 != closed] for use in leg.turns_in]
    uses = ["_".join(ways) for ways in kept]
    return uses if {"left", "right"} & set(uses) else []


def _lane_of(actor: Actor, lanes: int) -> int | None:
    """The lane of the only actor on a road that has so many now: the left one for a left turn."""
    turns_left = actor.out is not None and (actor.out - actor.leg) % 8 == TURN_OF["left"]
    return lanes if turns_left else actor.lane


def with_wrong_lanes(rng: Random, crash: Crash) -> Crash:
    """The crash as a careless hand draws it: other numbers of lanes, no turn lanes, no medians."""
    lanes = [(rng.choice((1, 1, 2, 2, 3)), rng.choice((1, 1, 2, 2, 3))) for _ in range(4)]
    legs = []
    for leg in crash.legs:
        one, other = lanes[leg.bearing % 4][:: 1 if leg.bearing < 4 else -1]
        into, away = one if leg.lanes_in else 0, other if leg.lanes_out else 0
        legs.append(replace(leg, lanes_in=into, lanes_out=away, turns_in=[], twltl=False, median="none"))
    return replace(crash, legs=legs)
