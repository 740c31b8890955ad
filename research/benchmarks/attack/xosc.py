"""Scenarios with parameters, distributions and catalogs: ours changed, every kind of element with odd values, and
shapes made to use a player up."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from research.benchmarks.attack import scenario_words as word
from research.benchmarks.fuzz.making import NUMBERS, changed, example

NAME = "xosc"
SLOW_S = 15.0
"""`sgcad play` gives a scenario 5 s of work to read and 10 s to play, however short its file is."""
_VALUE = re.compile(r'="[^"]*"')
_ODD = (
    *NUMBERS,
    "$p",
    "${1/0}",
    "${9**9}",
    "$",
    "V9",
    "..",
    "true",
    "-1e-9",
    "${pow(9,999)}",
    "x" * 9_000,
    "/dev/zero",
)
_CONDITIONS = (
    '<TimeHeadwayCondition entityRef="V2" value="9" freespace="false" rule="lessThan" coordinateSystem="road" '
    'relativeDistanceType="longitudinal"/>',
    '<TimeToCollisionCondition value="3" freespace="true" rule="lessThan"><TimeToCollisionConditionTarget>'
    '<EntityRef entityRef="V2"/></TimeToCollisionConditionTarget></TimeToCollisionCondition>',
    '<AccelerationCondition value="1" rule="greaterThan" direction="total"/>', '<EndOfRoadCondition duration="0.1"/>',
    '<OffroadCondition duration="0.1"/>', '<StandStillCondition duration="1"/>',
    '<RelativeClearanceCondition oppositeLanes="true" distanceForward="30" distanceBackward="9" freeSpace="true"/>',
    '<CollisionCondition><ByType type="vehicle"/></CollisionCondition>',
    f'<ReachPositionCondition tolerance="1">{word.lane(1, 40)}</ReachPositionCondition>',
    '<RelativeDistanceCondition entityRef="V2" relativeDistanceType="longitudinal" coordinateSystem="lane" value="5" '
    'freespace="true" rule="lessThan"/>', '<TraveledDistanceCondition value="9"/>',
)  # fmt: skip
_ACTIONS = (
    '<LongitudinalAction><LongitudinalDistanceAction entityRef="V2" distance="9" continuous="true" freespace="true">'
    '<DynamicConstraints maxAcceleration="3" maxDeceleration="5" maxSpeed="20"/></LongitudinalDistanceAction>'
    "</LongitudinalAction>",
    '<LongitudinalAction><SpeedProfileAction followingMode="position"><SpeedProfileEntry time="1" speed="9"/>'
    '<SpeedProfileEntry speed="4"/></SpeedProfileAction></LongitudinalAction>',
    '<LateralAction><LaneChangeAction><LaneChangeActionDynamics dynamicsShape="cubic" dynamicsDimension="distance" '
    'value="20"/><LaneChangeTarget><RelativeTargetLane entityRef="V1" value="-1"/></LaneChangeTarget>'
    "</LaneChangeAction></LateralAction>",
    '<LateralAction><LaneOffsetAction continuous="false"><LaneOffsetActionDynamics dynamicsShape="sinusoidal" '
    'maxLateralAcc="2"/><LaneOffsetTarget><AbsoluteTargetLaneOffset value="0.5"/></LaneOffsetTarget></LaneOffsetAction>'
    "</LateralAction>",
    f"<RoutingAction><AcquirePositionAction>{word.lane(1, 90)}</AcquirePositionAction></RoutingAction>",
    word.follow(f'<Clothoid curvature="0.01" curvatureDot="0.001" length="30">{word.world(0, 0)}</Clothoid>'),
    word.follow(
        f'<Nurbs order="2"><ControlPoint weight="1">{word.world(0, 0)}</ControlPoint><ControlPoint>{word.world(9, 0)}'
        '</ControlPoint><Knot value="0"/><Knot value="0"/><Knot value="1"/><Knot value="1"/></Nurbs>'
    ),
    word.follow(
        f'<Polyline><Vertex time="0">{word.world(0, 0)}</Vertex><Vertex time="2">{word.world(20, 1)}</Vertex>'
        "</Polyline>",
        '<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>', "follow",
    ),
    f'<SynchronizeAction masterEntityRef="V2"><TargetPositionMaster>{word.lane(1, 90)[10:-11]}</TargetPositionMaster>'
    f'<TargetPosition>{word.lane(1, 95)[10:-11]}</TargetPosition><FinalSpeed><AbsoluteSpeed value="5"/></FinalSpeed>'
    "</SynchronizeAction>",
)  # fmt: skip
_DRAWN = (
    '<NormalDistribution expectedValue="{0}" variance="{1}"/>', '<PoissonDistribution expectedValue="{0}"/>',
    '<LogNormalDistribution expectedValue="{0}" variance="{1}"><Range lowerLimit="0" upperLimit="9"/>'
    "</LogNormalDistribution>", '<UniformDistribution><Range lowerLimit="{0}" upperLimit="{1}"/></UniformDistribution>',
    '<Histogram><HistogramBin weight="{0}"><Range lowerLimit="0" upperLimit="{1}"/></HistogramBin></Histogram>',
    '<ProbabilityDistributionSet><Element value="{0}" weight="{1}"/></ProbabilityDistributionSet>',
)  # fmt: skip


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Folders with play.xosc and what it names."""
    for number in range(10**9):
        (place := folder / f"xosc-{number}").mkdir()
        (place / "m.xodr").write_text(word.PLAIN, encoding="utf-8")
        style = rng.random()
        if style < 0.3:
            (place / "road.xodr").write_text(example()[2], encoding="utf-8")
            (place / "play.xosc").write_bytes(changed(example()[3], rng))
        elif style < 0.6:
            (place / "play.xosc").write_text(_odd(rng, _rich(rng)), encoding="utf-8")
        else:
            _write(place, rng, rng.choice((_sets, _catalogs, _large))(rng))
        yield place


def _write(place: Path, rng: random.Random, files: dict[str, str]) -> None:
    for name, text in files.items():
        (place / name).parent.mkdir(exist_ok=True)
        (place / name).write_text(_odd(rng, text) if rng.random() < 0.4 else text, encoding="utf-8")


def _rich(rng: random.Random) -> str:
    """Some actions and conditions of every sort."""
    chosen = [
        (rng.choice(_ACTIONS), rng.choice(_CONDITIONS), rng.choice((1, 1, 50))) for _ in range(rng.randrange(1, 9))
    ]
    edges = ("none", "rising", "falling", "risingOrFalling")
    events = "".join(
        word.event(
            action, word.of_entity(test, rng.choice(edges)) if rng.random() < 0.6 else word.at(rng.random()), n, k
        )
        for k, (action, test, n) in enumerate(chosen)
    )
    declared = '<ParameterDeclaration name="p" parameterType="double" value="3"/>'
    return word.scenario(events, parameters=declared, end=word.at(rng.choice((3, 30))))


def _odd(rng: random.Random, text: str) -> str:
    """The same with some values changed."""
    for _ in range(rng.randrange(1, 5)):
        spots = list(_VALUE.finditer(text[:200_000]))
        spot = rng.choice(spots)
        text = f'{text[: spot.start()]}="{rng.choice(_ODD)}"{text[spot.end() :]}'
    return text


def _sets(rng: random.Random) -> dict[str, str]:
    """A distribution over a scenario."""
    n, runs = rng.choice((1, 50, 3_000)), rng.choice((1, 10, 10_000))
    numbers = ("1", "0.5", "10000", "1e6", "-1", *NUMBERS[:8])
    if rng.random() < 0.5:
        each = "".join(
            f'<StochasticDistribution parameterName="{rng.choice(("p", "$p"))}{k}">'
            f"{rng.choice(_DRAWN).format(rng.choice(numbers), rng.choice(numbers))}</StochasticDistribution>"
            for k in range(n)
        )
        inner = f'<Stochastic numberOfTestRuns="{runs}" randomSeed="{rng.choice(numbers)}">{each}</Stochastic>'
    else:
        ranged = '<DistributionRange stepWidth="{}"><Range lowerLimit="0" upperLimit="{}"/></DistributionRange>'
        each = "".join(
            f'<DeterministicSingleParameterDistribution parameterName="p{k}">'
            f"{ranged.format(rng.choice(numbers), rng.choice(numbers))}</DeterministicSingleParameterDistribution>"
            for k in range(n)
        )
        inner = f"<Deterministic>{each}</Deterministic>"
    declared = '<ParameterDeclaration name="p0" parameterType="double" value="3"/>'
    target = rng.choice(("s.xosc", "s.xosc", "play.xosc", "../../etc/passwd", "s.xosc" * 900))
    return {"play.xosc": word.distribution(inner, target), "s.xosc": word.scenario(parameters=declared)}


def _catalogs(rng: random.Random) -> dict[str, str]:
    """Routes that name each other, deep, broad or in a ring."""
    depth, broad = rng.choice((2, 9, 40)), rng.choice((1, 8, 300))

    def named(entry: object) -> str:
        ref = f'<CatalogReference catalogName="c" entryName="{entry}"/>'
        inner = '<InRoutePosition><FromRoadCoordinates pathS="1" t="0"/></InRoutePosition>'
        return f"<Position><RoutePosition><RouteRef>{ref}</RouteRef>{inner}</RoutePosition></Position>"

    last = depth if rng.random() < 0.7 else 0
    entries = "".join(
        f'<Route name="{k}" closed="false">'
        + f'<Waypoint routeStrategy="shortest">{named(k + 1 if k < depth - 1 else last)}</Waypoint>' * broad
        + "</Route>"
        for k in range(depth)
    )
    entries += f'<Route name="{depth}"><Waypoint routeStrategy="shortest">{word.lane(1, 5)}</Waypoint></Route>'
    paths = ("cat", "cat", ".", "/", "cat/../cat", "x" * 5_000, "/dev", "/proc/self")
    where = "".join(f'<RouteCatalog><Directory path="{rng.choice(paths)}"/></RouteCatalog>' for _ in range(3))
    return {"play.xosc": word.scenario(places=(named(0),), catalogs=where), "cat/c.xosc": word.catalog(entries)}


def _large(rng: random.Random) -> dict[str, str]:
    """Many of one thing."""
    n = rng.choice((100, 3_000, 20_000))
    seen = '<VisibilityAction graphics="true" traffic="true" sensors="true"/>'
    state = (
        '<ByValueCondition><StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="e" '
        'state="completeState"/></ByValueCondition>'
    )
    vertices = "".join(f'<Vertex time="{k / 1000}">{word.world(k / 100, 0)}</Vertex>' for k in range(n))
    timing = '<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>'
    doubled = "".join(f'<ParameterDeclaration name="p{k}" value="$p{k - 1}$p{k - 1}"/>' for k in range(1, 40))
    phases = "".join(
        f'<TrafficSignalController name="t{k}"><Phase name="p" duration="1"/></TrafficSignalController>'
        for k in range(n)
    )
    end, named = word.at(rng.choice((2, 290))), '<LogicFile filepath="m.xodr"/>'
    ways: tuple[Callable[[], str], ...] = (
        lambda: word.scenario("".join(word.event(seen, word.at(99), 1, k) for k in range(n)), end=end),
        lambda: word.scenario("".join(word.event(seen, word.trigger(state)) for _ in range(n)), end=end),
        lambda: word.scenario(
            "".join(word.event(rng.choice(_ACTIONS), word.of_entity(c), 999) for c in _CONDITIONS), end=end
        ),
        lambda: word.scenario(
            word.event(word.follow(f"<Polyline>{vertices}</Polyline>", timing, "follow"), word.at(0), n), end=end
        ),
        lambda: word.scenario(places=tuple(word.lane(1, k % 400) for k in range(min(n, 300))), end=end),
        lambda: word.scenario(parameters=f'<ParameterDeclaration name="p0" value="xxxxxxxx"/>{doubled}'),
        lambda: word.scenario(
            parameters="".join(f'<ParameterDeclaration name="p{k}" value="1"/>' for k in range(n))
        ),
        lambda: word.scenario(network=f"<TrafficSignals>{phases}</TrafficSignals>{named}", end=end),
        lambda: word.scenario(network=f'<LogicFile filepath="{"x" * n}"/>'),
        lambda: word.scenario(places=(word.world(f"-{n}e5", n), word.world(1e9, -1e9)), end=end),
        lambda: word.scenario("<a>" * n),
        lambda: word.scenario("<a/>" * n * 20),
        lambda: word.scenario().replace("<OpenSCENARIO>", '<!DOCTYPE a [<!ENTITY b "c">]><OpenSCENARIO>'),
        lambda: word.scenario().replace('length="4.5"', f'length="{n}"'),
    )  # fmt: skip
    return {"play.xosc": rng.choice(ways)()}


def feed(item: Path) -> None:
    """Play it with all that `sgcad play` writes."""
    from flows.player import play_any_xosc

    play_any_xosc.play(item / "play.xosc", item / "out", ["p=2"], [], 2, 60.0)
