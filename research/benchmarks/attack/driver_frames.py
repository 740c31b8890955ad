"""Frames of a driver behind a socket: good ones changed, odd JSON, leaps, length, depth, pieces without an end."""

from __future__ import annotations

import json
import math
import random
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from research.benchmarks.fuzz.making import NUMBERS

NAME = "driver frames"
SPEED_MPS, AFTER_S = 15.0, 6.0


def inputs(rng: random.Random, folder: Path) -> Iterator[bytes]:
    """What a driver sends, line by line; the last line is sent again and again."""
    while True:
        good = [_good(rng) for _ in range(rng.randrange(1, 9))]
        yield b"\n".join((*good, _odd(rng))) + rng.choice((b"\n", b"\n", b""))


def _good(rng: random.Random) -> bytes:
    return json.dumps({"acceleration_mps2": rng.uniform(-9, 3), "steering_rad": rng.uniform(-0.6, 0.6)}).encode()


def _odd(rng: random.Random) -> bytes:
    number = rng.choice((rng.uniform(-1e3, 1e3), 1e300, math.nan, math.inf, 10**400, True, None, "1", [], {}))
    size = rng.choice((10, 10_000, 490_000, 1_000_000, 3_000_000))
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: _good(rng),
        lambda: _json(rng, {"acceleration_mps2": number, "steering_rad": rng.choice((number, 0.1))}),
        lambda: _json(rng, {"trajectory": _leap(rng)}),
        lambda: _json(rng, {"trajectory": [[number] * rng.randrange(7)] * rng.randrange(4)}),
        lambda: _json(rng, rng.choice(([], "go", 3, None, [[]], {"view": {}}, {"acceleration_mps2": 0, "x": [[[]]]}))),
        lambda: b'{"acceleration_mps2": ' + rng.choice(NUMBERS).encode("utf-8", "replace") + b"}",
        lambda: b'{"acceleration_mps2": 1, "x": "' + b"y" * size + b'"}',
        lambda: b"[" * size,
        lambda: b'{"a":' * (size // 10) + b"1",
        lambda: b'{"acceleration_mps2": ' + b"9" * size + b"}",
        lambda: b'{"trajectory": [' + b"[0.05,1,1,1,1]," * (size // 16) + b"[1,1,1,1,1]]}",
        lambda: rng.randbytes(rng.randrange(2_000)).replace(b"\n", b" "),
        lambda: _good(rng)[: rng.randrange(60)],
    )
    return rng.choice(ways)()


def _leap(rng: random.Random) -> list[list[float]]:
    """Rows that begin where the ego is at first, or anywhere, and go on in steps of any size."""
    far = rng.choice((0.0, 0.1, 10.0, 1e6, 1e300))
    times = sorted(rng.uniform(0, rng.choice((0.05, 2.0))) for _ in range(rng.randrange(1, 30)))
    return [[t, -95 + SPEED_MPS * t + rng.uniform(-far, far), rng.uniform(-far, far), 0.0, SPEED_MPS] for t in times]


def _json(rng: random.Random, value: Any) -> bytes:
    return json.dumps(value, separators=rng.choice(((",", ":"), (" , ", "  :")))).encode()


# ------------------------------------------------------------------ the drive
def feed(item: bytes) -> None:
    """Let the frames drive a car towards a standing one. Raises AssertionError where a leap is credited."""
    from plugins.driver.external import External
    from sgcad_core.handover.drive import drive
    from sgcad_core.handover.outcome import judge_drive

    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=_say, args=(server, item), daemon=True).start()
        driven = drive(_staging(), External(port=server.getsockname()[1], timeout_s=5.0))
    judge_drive(driven)
    moved = np.hypot(np.diff(driven.ego.x_m), np.diff(driven.ego.y_m)).max(initial=0.0)
    assert moved <= 1.02 * 70.0 * 0.05, f"{moved:g} m within a step, faster than a car"  # noqa: S101 - as told above


def _say(server: socket.socket, said: bytes) -> None:
    """Answer each line with the next line of what is said."""
    lines = said.split(b"\n")
    ends = len(lines) > 1 and not lines[-1]
    lines = lines[:-1] if ends else lines
    with suppress(OSError), server.accept()[0] as door:
        for number, _ in enumerate(door.makefile("rb")):
            last = number >= len(lines)
            door.sendall((b"{}" if number == 0 else lines[min(number, len(lines)) - 1]) + b"\n")
            if last and not ends:
                return


@cache
def _staging() -> Any:
    """V1 runs at 15 m/s into the rear of V2, which stands."""
    from sgcad_core.case.records import ActorInfo, Trajectory
    from sgcad_core.handover.script import Script, staging_for
    from sgcad_core.records.specs import Contact
    from sgcad_core.roads.lane_graph import LaneGraph

    t = np.round(np.arange(181) * 0.05, 3)
    tracks = []
    for name, speed in (("V1", SPEED_MPS), ("V2", 0.0)):
        x = (-4.68 if name == "V1" else 0.0) + np.minimum(t - AFTER_S, 0.0) * speed
        moving = np.where(t < AFTER_S, speed, 0.0)
        tracks.append(Trajectory(actor=name, t_s=t, x_m=x, y_m=t * 0, heading_rad=t * 0, speed_mps=moving))
    actors = tuple(
        ActorInfo(id=name, type="car", length_m=4.7, width_m=1.8, maneuver="straight") for name in ("V1", "V2")
    )
    contact = Contact(striker="V1", struck="V2", striker_area="front", struck_area="back")
    return staging_for(Script("made", actors, tuple(tracks), LaneGraph({}, (), {}), contact, {}, None), "V1")
