"""SUMO networks: one of ours with values, elements and bytes changed, and shapes made to use a reader up."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path

from research.benchmarks.fuzz.making import NUMBERS, changed, example

NAME = "net"


def inputs(rng: random.Random, folder: Path) -> Iterator[str]:
    """Texts of .net.xml files."""
    while True:
        own = example()[1]
        yield changed(own, rng).decode("utf-8", "replace") if rng.random() < 0.7 else _evil(rng, own)


def _evil(rng: random.Random, own: str) -> str:
    count, odd = rng.choice((10, 1_000, 20_000)), rng.choice(NUMBERS)
    lane = f'<lane id="a_{{}}" index="{{}}" speed="{odd}" length="{odd}" shape="0,0 1,1"/>'
    ways: tuple[Callable[[], str], ...] = (
        lambda: _net('<edge id="a">' + "".join(lane.format(k, k) for k in range(count)) + "</edge>"),
        lambda: _net("".join(f'<edge id="e{k}" from="e" to="e" shape="{odd},{odd}"/>' for k in range(count))),
        lambda: _net('<edge id="a" shape="' + "0,0 " * count * 10 + '"/>'),
        lambda: _net("".join('<connection from="a" to="a" fromLane="0" toLane="0"/>' for _ in range(count))),
        lambda: _net("<edge>" * min(count, 5_000)),
        lambda: own.replace("</net>", own[own.find("<edge") :]),
        lambda: own.replace("<edge", '<edge from="x" to="y"', count),
        lambda: f'<!DOCTYPE net [<!ENTITY a "{"b" * count}">]><net>&a;</net>',
        lambda: own.replace(" ", rng.choice(("\n" * count, "\t", "\x00"))),
    )
    return rng.choice(ways)()


def _net(inner: str) -> str:
    return f'<net version="1.16"><location netOffset="0,0" convBoundary="0,0,1,1"/>{inner}</net>'


def feed(item: str) -> None:
    """Read a network, tell its roads in words and draw them, as prompts and the player do."""
    from flows.player.road_shapes import drawing_of
    from sgcad_core.formats.sumo.net_xml import parse_net
    from sgcad_core.roads.describe import describe_network

    describe_network(parse_net(item))
    drawing_of(item)
