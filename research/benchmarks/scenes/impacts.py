"""How far the impact model's change of velocity is off in staged collisions, by impact mode, with its sign.

    python -m research.benchmarks.scenes.impacts [--tests] [--restitution 0.1] [--friction 0.5]

Inputs and measurements stand in `staged_collisions.yaml` with their sources. Both vehicles are boxes of the measured
size and mass. They are placed so that their measured centers of impact meet, and moved back along their relative
velocity until they only just touch; there the model (`sgcad_core.handover.severity`) takes over. The error is (model -
measured) / measured; measured is the mean of what several authors derive from the same accelerometers.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from sgcad_core.handover.severity import exchanged
from sgcad_core.planner.aftermath.impact import FRICTION, RESTITUTION, Body, body
from sgcad_core.planner.aftermath.wreck_bodies import separation

FILE = Path(__file__).with_name("staged_collisions.yaml")
TOUCH_M = 0.01
"""So far the boxes overlap as they touch."""
_BACK_M, _GRAIN_M = 8.0, 0.002
WALL_M = 1.0
WALL_MODE = "front to fixed wall, small overlap"


class Off(NamedTuple):
    """One vehicle of one test, m/s."""

    test: str
    mode: str
    vehicle: int
    model_mps: float
    measured_mps: float
    spread_mps: float
    """Between authors."""

    @property
    def error(self) -> float:
        """Signed, as a share of what was measured."""
        return (self.model_mps - self.measured_mps) / self.measured_mps


# ------------------------------------------------------------------ placing
def impact_point(vehicle: Mapping[str, Any]) -> tuple[float, float]:
    """Center of impact in the box's own frame, from the middle of the box (x ahead, y left), metres."""
    length, width = vehicle["size"]
    angle, *distance = vehicle["center"]
    ahead = vehicle.get("ahead", length / 2) - length / 2
    x, y = -ahead, 0.0  # of the center of mass
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    if distance:
        return x + distance[0] * c, y + distance[0] * s
    reaches = [((math.copysign(length / 2, c) - x) / c) if abs(c) > 1e-9 else math.inf,
               ((math.copysign(width / 2, s) - y) / s) if abs(s) > 1e-9 else math.inf]  # fmt: skip
    reach = min(reaches)
    return x + reach * c, y + reach * s


def placed(pair: Mapping[str, Any]) -> tuple[Body, Body]:
    """Both as they come to touch, moving."""
    first, second = (_moving(pair[k], h) for k, h in (("first", 0.0), ("second", math.radians(pair["heading"]))))
    (ax, ay), (bx, by) = (impact_point(pair[k]) for k in ("first", "second"))
    c, s = math.cos(second.heading), math.sin(second.heading)
    x, y = ax - (bx * c - by * s), ay - (bx * s + by * c)
    return _touching(first, second, (x, y))


def _moving(vehicle: Mapping[str, Any], heading: float) -> Body:
    made = body((0.0, 0.0, heading), tuple(vehicle["size"]), vehicle["mass"])
    made.vx, made.vy = vehicle["speed"] * math.cos(heading), vehicle["speed"] * math.sin(heading)
    return made


def _touching(first: Body, second: Body, at: tuple[float, float]) -> tuple[Body, Body]:
    """The second one at a place, then back along the relative velocity to where they touched first."""
    vx, vy = first.vx - second.vx, first.vy - second.vy
    speed = math.hypot(vx, vy)
    for back in np.arange(_BACK_M, -_BACK_M, -_GRAIN_M):
        second.x, second.y = at[0] + back * vx / speed, at[1] + back * vy / speed
        if separation(first, second).gap_m <= -TOUCH_M:
            return first, second
    raise ValueError("the two do not touch: mend the test's centers of impact")


# ------------------------------------------------------------------ the tests
def offs(restitution: float = RESTITUTION, friction: float = FRICTION, file: Path = FILE) -> list[Off]:
    """Every vehicle of every test."""
    told = yaml.safe_load(file.read_text(encoding="utf-8"))
    found = [off for pair in told["pairs"] for off in _pair(pair, restitution, friction)]
    return found + list(_walls(told["walls"], restitution, friction))


def _pair(pair: Mapping[str, Any], restitution: float, friction: float) -> Iterator[Off]:
    first, second = placed(pair)
    energy = first.energy + second.energy
    changes = exchanged(first, second, restitution, friction)
    if first.energy + second.energy > energy:
        raise ArithmeticError(f"{pair['test']}: the impact gains energy")
    measured = np.array(pair["delta_v"])
    for k, change in enumerate(changes):
        seen = measured[:, k]
        yield Off(pair["test"], pair["mode"], k + 1, math.hypot(*change), float(seen.mean()), float(np.ptp(seen)))


def _walls(told: Mapping[str, Any], restitution: float, friction: float) -> Iterator[Off]:
    length, width = told["vehicle"]["size"]
    for test in told["tests"]:
        car = _moving({**told["vehicle"], "speed": test["speed"]}, 0.0)
        aside = width / 2 - test["overlap"] * width + WALL_M / 2  # the wall reaches in from the left
        wall = body(((length + WALL_M) / 2 - TOUCH_M, aside, 0.0), (WALL_M, WALL_M), None)
        change, _ = exchanged(car, wall, restitution, friction)
        yield Off(test["test"], WALL_MODE, 1, math.hypot(*change), test["delta_v"], 0.0)


# ------------------------------------------------------------------ told
def table(found: list[Off]) -> str:
    """A row a mode: signed mean error, root mean square, worst."""
    lines = [
        "| impact mode | tests | vehicles | mean signed error | root mean square | worst |",
        "|---|---|---|---|---|---|",
    ]
    modes = dict.fromkeys(off.mode for off in found)
    for mode, some in [*((m, [o for o in found if o.mode == m]) for m in modes), ("two vehicles, all", _two(found))]:
        e = np.array([off.error for off in some])
        worst = float(e[np.abs(e).argmax()])
        tests = len({off.test for off in some})
        rms = math.sqrt(float((e**2).mean()))
        lines.append(f"| {mode} | {tests} | {len(e)} | {e.mean():+.1%} | {rms:.1%} | {worst:+.1%} |")
    return "\n".join(lines)


def _two(found: list[Off]) -> list[Off]:
    return [off for off in found if off.mode != WALL_MODE]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table, and with --tests every vehicle."""
    parser = argparse.ArgumentParser(
        prog="python -m research.benchmarks.scenes.impacts", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--tests", action="store_true", help="every vehicle of every test")
    parser.add_argument("--restitution", type=float, default=RESTITUTION)
    parser.add_argument("--friction", type=float, default=FRICTION)
    given = parser.parse_args(arguments)
    found = offs(given.restitution, given.friction)
    out = sys.stdout
    if given.tests:
        out.write(
            "| test | vehicle | model m/s | measured m/s | between authors | error |\n|---|---|---|---|---|---|\n"
        )
        for o in found:
            figures = f"{o.model_mps:.2f} | {o.measured_mps:.2f} | {o.spread_mps:.2f} | {o.error:+.1%}"
            out.write(f"| {o.test} | {o.vehicle} | {figures} |\n")
        out.write("\n")
    out.write(table(found) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
