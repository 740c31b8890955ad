"""Maps: ours with values, elements and bytes changed, and shapes made to use a reader up, each under a scenario."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path

from research.benchmarks.attack.scenario_words import chained, geometry, lane, network, road, scenario, width
from research.benchmarks.fuzz.making import NUMBERS, changed, example

NAME = "xodr"
SLOW_S = 8.0
"""A small map may stand for much road: `sgcad play` gives reading and playing a budget, not so much for each byte."""
_GET_THERE = (
    '<Event name="e" priority="parallel"><Action name="a"><PrivateAction><RoutingAction><AcquirePositionAction>{}'
    "</AcquirePositionAction></RoutingAction></PrivateAction></Action></Event>"
)


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Folders with s.xosc and m.xodr."""
    for number in range(10**9):
        (place := folder / f"xodr-{number}").mkdir()
        own = rng.random() < 0.6
        text = changed(example()[2], rng) if own else _evil(rng).encode("utf-8", "surrogatepass")
        (place / "m.xodr").write_bytes(text)
        told = example()[3].replace("road.xodr", "m.xodr") if own else scenario(*_driven(rng))
        (place / "s.xosc").write_text(told, encoding="utf-8")
        yield place


def _driven(rng: random.Random) -> tuple[str, tuple[str, ...]]:
    last = rng.choice((1, 2, 99, 2_000))
    return rng.choice(("", _GET_THERE.format(lane(last, 1)))), (lane(1, 1), lane(rng.choice((1, last)), 1))


def _evil(rng: random.Random) -> str:
    n, odd = rng.choice((3, 200, 3_000, 30_000)), rng.choice(NUMBERS)
    length = rng.choice((0.001, 1, 100, 20_000))
    shapes = (
        "<line/>", '<arc curvature="{}"/>', '<spiral curvStart="0" curvEnd="{}"/>',
        '<poly3 a="0" b="{0}" c="{0}" d="0"/>',
        '<paramPoly3 aU="0" bU="{0}" cU="{0}" dU="0" aV="0" bV="1" cV="{0}" dV="0" pRange="arcLength"/>',
    )  # fmt: skip
    shape = rng.choice(shapes).format(rng.choice((odd, "0.01", "1e6", "-3")))
    line, lanes = geometry(0, 0, length, shape), "".join(width(-k) for k in range(1, min(n, 300)))
    border = "".join(f'<width sOffset="{k * rng.random()}" a="3" b="0" c="0" d="{odd}"/>' for k in range(n))
    sections = "".join(f'<laneSection s="{k}"><right>{width(-1)}</right></laneSection>' for k in range(n))
    end = '<successor elementType="junction" elementId="j"/>'
    into = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    connections = "".join(
        f'<connection id="{k}" incomingRoad="1" connectingRoad="{k}" contactPoint="start"><laneLink from="-1" to="-1"/>'
        "</connection>" for k in range(2, n)
    )  # fmt: skip
    ring = '<successor elementType="road" elementId="1" contactPoint="start"/>'
    ways: tuple[Callable[[], str], ...] = (
        lambda: network(road(1, geometry(0, 0, length, shape) * n, min(length * n, 20_000))),
        lambda: network("".join(road(k, line, length, link=chained(k, n)) for k in range(1, n + 1))),
        lambda: network("".join(road(k, line, length, link=ring) for k in range(1, n + 1))),
        lambda: network(road(1, line, length, sections=f'<laneSection s="0"><right>{lanes}</right></laneSection>')),
        lambda: network(
            road(1, line, length, sections=f'<laneSection s="0"><right>{width(-1, border)}</right></laneSection>')
        ),
        lambda: network(road(1, line, length, sections=sections)),
        lambda: network(road(1, line, odd)),
        lambda: network(road(1, geometry(odd, odd, odd), 100)),
        lambda: network(
            road(1, line, length, link=end) + f'<junction id="j">{connections}</junction>'
            + "".join(road(k, line, length, link=into + ring, junction="j") for k in range(2, min(n, 4_000)))
        ),
        lambda: "<OpenDRIVE>" + "<a>" * rng.choice((200, 300, 100_000)),
        lambda: network("<a/>" * n * 10),
        lambda: network("<road " + " ".join(f"a{k}='{odd}'" for k in range(n)) + "/>"),
    )  # fmt: skip
    return rng.choice(ways)()


def feed(item: Path) -> None:
    """Play the scenario on the map, with all that `sgcad play` writes, and check the map."""
    from flows.player import play_any_xosc
    from sgcad_core.formats.opendrive.checks.road_index import lane_index

    play_any_xosc.play(item / "s.xosc", item / "out", [], [], 1, 60.0)
    lane_index((item / "m.xodr").read_text(encoding="utf-8", errors="replace"))
