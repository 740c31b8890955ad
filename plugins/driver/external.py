"""A driver outside this project: a Python callable, or a program behind a local socket, asked 20 times a second.

A callable `package.module:function` is called with what a socket would be sent and answers the same; a class is built
once a drive. Over the socket goes one JSON object a line. First {"task": ...} (ego, way, friction), answered by any
object, then {"view": ...} with the ego and all others; the answer is {"acceleration_mps2": a, "steering_rad": d} (the
steering may lack: the ego keeps to its way) or {"trajectory": [[t_s, x_m, y_m, heading_rad, speed_mps], ...]} with t_s
from now on. At the end {"leave": true}. docs/examples/driver_socket.py is such a program.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import socket
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from pydantic import Field, ValidationError, model_validator

from plugins.driver._external_answers import command
from sgcad_core.case.driver_io import STEP_S, Command, RoadUser, Seat, Task, View
from sgcad_core.errors import ConfigError, SimulationFailed
from sgcad_core.interfaces import Driver

LONGEST_LINE = 500_000
"""Bytes of an answer: 2,000 rows of five numbers have 200,000. A longer one is not parsed."""
Answer = Callable[[dict[str, Any]], Any]


class External(Driver):
    """Lets a Python callable (target) or a program behind a local socket (host, port) drive; give one of the two."""

    target: str = Field("", pattern=r"^$|^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")
    """package.module:function."""
    port: int | None = Field(None, ge=1, le=65535)
    """Of a server on this machine."""
    host: str = "127.0.0.1"
    timeout_s: float = Field(5.0, gt=0, le=600)
    """Longest wait for a whole answer, seconds."""

    @model_validator(mode="after")
    def _one_of_both(self) -> External:
        if bool(self.target) == (self.port is not None):
            raise ValueError("give target (package.module:function) or port, not both and not neither")
        return self

    def take_over(self, task: Task) -> Seat:
        """Sends the task. Raises ConfigError (no such callable), SimulationFailed (no answer)."""
        answer, close = (_callable(self.target), _nothing) if self.target else _connected(self)
        seat = _Seat(answer, close)
        answer({"task": _task(task)})
        return seat


class _Seat(Seat):
    def __init__(self, answer: Answer, close: Callable[[], None]) -> None:
        self._answer, self._close = answer, close

    def act(self, view: View) -> Command:
        """The command that the driver answers. Raises SimulationFailed for an invalid answer."""
        said = self._answer({"view": _view(view)})
        try:
            return command(said, view.ego)
        except (ValueError, RecursionError) as fault:
            raise SimulationFailed(
                f"the external driver answered {_short(said)} ({_first(fault)}); "
                "expected acceleration_mps2 and steering_rad, or trajectory"
            ) from fault

    def leave(self) -> None:
        """Tells the driver that the drive is over."""
        self._close()


def _short(said: Any) -> str:
    """The beginning of an answer; a number may have more digits than Python writes out."""
    try:
        return repr(str(said)[:200])
    except (ValueError, RecursionError):
        return f"a {type(said).__name__}"


def _first(fault: Exception) -> str:
    """The first fault of an answer in words."""
    if not isinstance(fault, ValidationError):
        return str(fault)
    about = fault.errors(include_url=False, include_input=False)[0]
    return f"{'.'.join(map(str, about['loc']))}: {about['msg']}"


# ------------------------------------------------------------------ the two doors
def _nothing() -> None:
    return None


def _callable(target: str) -> Answer:
    module, _, name = target.partition(":")
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as fault:
        raise ConfigError(f"driver external: target {target!r} cannot be imported ({fault})") from fault
    answer: Answer = found() if isinstance(found, type) else found
    if not callable(answer):
        raise ConfigError(f"driver external: target {target!r} is no callable")
    return answer


def _connected(config: External) -> tuple[Answer, Callable[[], None]]:
    where = f"{config.host}:{config.port}"
    try:
        door = socket.create_connection((config.host, config.port or 0), timeout=config.timeout_s)
    except OSError as fault:
        raise SimulationFailed(
            f"driver external: nobody listens at {where} ({fault}); start the driver first"
        ) from fault
    line = _Line(door, config.timeout_s)

    def answer(message: dict[str, Any]) -> Any:
        try:
            said = line.asked(json.dumps(message).encode())
        except TimeoutError as fault:
            raise SimulationFailed(
                f"the external driver at {where} has not answered within timeout_s = {config.timeout_s:g} s"
            ) from fault
        except OSError as fault:
            raise SimulationFailed(f"the external driver at {where} has hung up ({fault})") from fault
        except _TooLong as fault:
            raise SimulationFailed(
                f"the external driver at {where} answered {fault}: expected one JSON object a line, "
                f"at most {LONGEST_LINE} bytes"
            ) from fault
        try:
            return json.loads(said)
        except (ValueError, RecursionError) as fault:  # a line of brackets is deeper than json goes
            raise SimulationFailed(
                f"the external driver at {where} answered {said[:80]!r}: expected one JSON object a line ({fault})"
            ) from fault

    return answer, line.close


class _TooLong(Exception):
    """A line that is not parsed; the message is its beginning."""


class _Line:
    """Lines over a socket; the limit is for a whole question with its answer."""

    def __init__(self, door: socket.socket, timeout_s: float) -> None:
        self._door, self._timeout_s, self._read = door, timeout_s, bytearray()

    def asked(self, question: bytes) -> bytes:
        """The line that comes back. Raises TimeoutError (not within the limit), OSError (hung up), _TooLong."""
        until = time.monotonic() + self._timeout_s
        self._door.settimeout(self._timeout_s)
        self._door.sendall(question + b"\n")
        while (end := self._read.find(b"\n")) < 0 and len(self._read) <= LONGEST_LINE:
            self._door.settimeout(_left(until))
            piece = self._door.recv(1 << 16)
            if not piece:
                raise ConnectionResetError("no line came back")
            self._read += piece
        if not 0 <= end <= LONGEST_LINE:
            raise _TooLong(repr(bytes(self._read[:80])))
        said = bytes(self._read[:end])
        del self._read[: len(said) + 1]
        return said

    def close(self) -> None:
        """Sends the end of the drive if the connection is still open."""
        with self._door, contextlib.suppress(OSError):
            self._door.settimeout(self._timeout_s)
            self._door.sendall(b'{"leave": true}\n')


def _left(until: float) -> float:
    """Seconds left. Raises TimeoutError if there are none."""
    if (left := until - time.monotonic()) <= 0:
        raise TimeoutError
    return left


# ------------------------------------------------------------------ messages
def _user(user: RoadUser) -> dict[str, Any]:
    return {k: round(v, 6) if isinstance(v, float) else v for k, v in user._asdict().items()}


def _task(task: Task) -> dict[str, Any]:
    return {
        "case": task.case,
        "step_s": STEP_S,
        "ego": _user(task.ego),
        "way": np.round(np.column_stack((task.way.s_m, task.way.pose, task.way.speed_mps)), 4).tolist(),
        "friction_mps2": task.friction_mps2,
        "speed_limit_mps": task.speed_limit_mps,
        "gives_way_m": task.gives_way_m,
    }


def _view(view: View) -> dict[str, Any]:
    return {
        "t_s": round(view.t_s, 3),
        "ego": _user(view.ego),
        "station_m": round(view.station_m, 4),
        "script_s": round(view.script_s, 4),
        "others": [_user(u) for u in view.others],
    }
