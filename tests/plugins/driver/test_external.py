"""Somebody else's driver: a callable, and a program behind a socket."""

import contextlib
import json
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from pydantic import ValidationError

from plugins.driver.external import External, _Line
from sgcad_core.errors import ConfigError, PluginFault, SimulationFailed
from sgcad_core.handover.drive import drive
from sgcad_core.handover.outcome import judge_drive
from sgcad_core.handover.script import staging_for
from tests.sgcad_core.handover.scenes import rear_end

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "driver_socket.py"
HERE = "tests.plugins.driver.test_external"
SAID = []
FAULT = []


def brake_at_once(message):
    SAID.append(message)
    return {"acceleration_mps2": -5.0} if "view" in message else None


class Swerve:
    """A new one a drive: it counts its own steps."""

    def __init__(self):
        self.steps = 0

    def __call__(self, message):
        self.steps += "view" in message
        return {"acceleration_mps2": 0.0, "steering_rad": 0.05 if self.steps < 30 else 0.0}


def along(message):
    if "task" in message:
        return {}
    ego = message["view"]["ego"]
    return {"trajectory": [[0.0, ego["x_m"], ego["y_m"], 0.0, 15.0], [1.0, ego["x_m"] + 15.0, ego["y_m"], 0.0, 15.0]]}


def falls(message):
    if "view" in message:
        raise FAULT[-1]


def nonsense(message):
    return {"brake": "yes"}


def staged_rear_end():
    return staging_for(rear_end(own=15.0), "V1")


def test_a_callable_sees_itself_and_the_others_20_times_a_second():
    SAID.clear()
    driven = drive(staged_rear_end(), External(target=f"{HERE}:brake_at_once"))
    assert driven.contact is None
    assert set(SAID[0]["task"]) >= {"ego", "way", "friction_mps2", "step_s"}
    times = [m["view"]["t_s"] for m in SAID[1:4]]
    assert times == [0.0, 0.05, 0.1]
    assert [o["actor"] for o in SAID[1]["view"]["others"]] == ["V2"]


def test_a_callable_may_steer_or_give_a_trajectory():
    assert drive(staged_rear_end(), External(target=f"{HERE}:Swerve")).contact is None
    driven = drive(staged_rear_end(), External(target=f"{HERE}:along"))
    assert driven.ego.speed_mps[10] == pytest.approx(15.0)


def test_the_example_avoids_a_standing_car_over_its_socket():
    program = subprocess.Popen([sys.executable, str(EXAMPLE), "0"], stdout=subprocess.PIPE, text=True)
    try:
        port = int(program.stdout.readline())
        assert judge_drive(drive(staged_rear_end(), External(port=port))).outcome == "avoided"
    finally:
        program.kill()
        program.wait()


def test_an_answer_that_is_none_is_named():
    with pytest.raises(SimulationFailed, match=r"answered .*brake.*expected acceleration_mps2"):
        drive(staged_rear_end(), External(target=f"{HERE}:nonsense"))


def test_a_callable_that_is_not_there_is_named():
    with pytest.raises(ConfigError, match=r"target 'no\.such:thing' cannot be imported"):
        drive(staged_rear_end(), External(target="no.such:thing"))
    with pytest.raises(ConfigError, match="is no callable"):
        drive(staged_rear_end(), External(target=f"{HERE}:HERE"))


def test_nobody_at_the_port_is_told_and_so_is_one_who_hangs_up():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(SimulationFailed, match=f"nobody listens at 127.0.0.1:{port}"):
        drive(staged_rear_end(), External(port=port))
    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=lambda: server.accept()[0].close(), daemon=True).start()
        with pytest.raises(SimulationFailed, match="has hung up"):
            drive(staged_rear_end(), External(port=server.getsockname()[1]))


def served(answers):
    """A server on a port of its own that gives its first caller to `answers`."""
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        line, _ = server.accept()
        with server, line:
            answers(line)

    threading.Thread(target=serve, daemon=True).start()
    return server.getsockname()[1]


def dripping(line):
    """A byte every 50 ms, each within the limit of 0.4 s, and never a whole line."""
    with contextlib.suppress(OSError):
        while True:
            line.sendall(b" ")
            time.sleep(0.05)


def test_an_answer_that_comes_byte_by_byte_has_the_time_of_one_answer():
    began = time.monotonic()
    with pytest.raises(SimulationFailed, match=r"has not answered within timeout_s = 0\.4 s"):
        drive(staged_rear_end(), External(port=served(dripping), timeout_s=0.4))
    assert 0.4 <= time.monotonic() - began < 3.0


def test_one_who_says_nothing_is_waited_for_as_long():
    with pytest.raises(SimulationFailed, match=r"has not answered within timeout_s = 0\.2 s"):
        drive(staged_rear_end(), External(port=served(lambda line: time.sleep(2.0)), timeout_s=0.2))


def test_one_who_does_not_listen_is_not_waited_for_either():
    """Its buffers are full at some time; the question is part of the limit."""
    line = _Line(socket.create_connection(("127.0.0.1", served(lambda line: time.sleep(5.0)))), 0.3)
    began = time.monotonic()
    with pytest.raises(TimeoutError):
        line.asked(b" " * 50_000_000)
    assert time.monotonic() - began < 3.0
    line.close()


def test_an_answer_in_pieces_is_one_answer_and_what_follows_is_the_next():
    def pieces(line):
        file = line.makefile("rb")
        file.readline()
        for piece in (b'{"a"', b": 1", b'}\n{"b": 2}\n'):
            line.sendall(piece)
            time.sleep(0.02)
        file.readline()

    line = _Line(socket.create_connection(("127.0.0.1", served(pieces))), 5.0)
    assert line.asked(b"{}") == b'{"a": 1}'
    assert line.asked(b"{}") == b'{"b": 2}'
    line.close()


def test_an_answer_deeper_than_json_goes_is_told():
    def answers(line):
        line.makefile("rb").readline()
        line.sendall(b"[" * 300_000 + b"\n")

    with pytest.raises(SimulationFailed, match=r"answered b'\[+': expected one JSON object a line"):
        drive(staged_rear_end(), External(port=served(answers)))


def test_an_answer_without_an_end_is_told():
    port = served(lambda line: (line.makefile("rb").readline(), line.sendall(b"1" * (1 << 21)), time.sleep(1.0)))
    with pytest.raises(SimulationFailed, match=r"answered b'1+': expected one JSON object .* at most 500000 bytes"):
        drive(staged_rear_end(), External(port=port))


def test_a_frame_of_a_megabyte_is_refused_by_its_size_before_it_is_parsed(monkeypatch):
    """It would be a good answer but for its length."""
    parsed, loads = [], json.loads
    monkeypatch.setattr(json, "loads", lambda said: parsed.append(len(said)) or loads(said))
    frame = b'{"acceleration_mps2": -5.0' + b" " * 1_000_000 + b"}\n"

    def answers(line):
        with contextlib.suppress(OSError):
            for _ in line.makefile("rb"):
                line.sendall(b"{}\n" if not parsed else frame)

    with pytest.raises(SimulationFailed, match=r"answered b'.*': expected one JSON object .* at most 500000 bytes"):
        drive(staged_rear_end(), External(port=served(answers)))
    assert parsed == [2]


@pytest.mark.parametrize("raised", [KeyError("x"), ZeroDivisionError(), SystemExit(3), RecursionError(), MemoryError()])
def test_a_callable_that_raises_ends_its_own_drive_only(raised):
    FAULT.append(raised)
    with pytest.raises(PluginFault, match=f"driver 'external' .*its seat's act raised {type(raised).__name__}"):
        drive(staged_rear_end(), External(target=f"{HERE}:falls"))


def test_one_door_is_needed_and_not_two():
    for fields in ({}, {"target": "a:b", "port": 80}):
        with pytest.raises(ValidationError, match="not both and not neither"):
            External(**fields)
