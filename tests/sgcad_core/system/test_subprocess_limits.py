"""A program that uses the machine up is ended, whatever it uses up."""

import os
import subprocess
import sys
import time

import pytest

from sgcad_core.case.records import PlainXml
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.system.subprocess_limits import run_limited

PYTHON = [sys.executable, "-S", "-c"]


def run(code, tmp_path, **limits):
    return run_limited([*PYTHON, code], tmp_path, os.environ, limits.pop("timeout_s", 60), **limits)


def test_output_and_exit_code_come_back(tmp_path):
    done = run("import sys; print('out'); print('err', file=sys.stderr); sys.exit(3)", tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (3, b"out\n", b"err\n")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of other processes are Linux's")
def test_memory_and_files_are_limited(tmp_path):
    wait = "import time; time.sleep(0.3)\n"
    assert run(wait + "bytearray(3 * 2**30)", tmp_path, memory_mb=500).returncode == 1
    assert run(wait + "open('f', 'wb').write(bytes(3 * 2**20))", tmp_path, file_mb=1).returncode != 0
    assert (tmp_path / "f").stat().st_size <= 2**20


def test_time_is_limited_and_nothing_stays_behind(tmp_path):
    started = time.monotonic()
    with pytest.raises(subprocess.TimeoutExpired, match="timed out after"):
        run("import time; time.sleep(600)", tmp_path, timeout_s=0.5)
    assert time.monotonic() - started < 30


def test_a_road_of_a_million_lanes_is_a_finding():
    nodes = "<nodes><node id='a' x='0' y='0'/><node id='b' x='100' y='0'/></nodes>"
    made = compile_network(
        PlainXml(nodes=nodes, edges="<edges><edge id='e' from='a' to='b' numLanes='1000000'/></edges>")
    )
    assert made.net_xml is None
    assert "at most 16 lanes at edges, line 1 (found 1000000)" in made.log
