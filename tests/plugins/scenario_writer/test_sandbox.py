"""Scripts run in the sandbox: honest ones come back as a scenario, a hundred hostile ones do not get out."""

from __future__ import annotations

import dataclasses
import re
import socket
import textwrap
import time
from concurrent.futures import ThreadPoolExecutor

import psutil
import pytest

from plugins.scenario_writer.sandbox import script_runner
from plugins.scenario_writer.sandbox.script_rules import breaches, parsed
from plugins.scenario_writer.sandbox.script_runner import Limits, run_script
from sgcad_core import settings
from sgcad_core.errors import ConfigError
from tests.effort import spread
from tests.plugins.scenario_writer.escapes import RAW, RULED
from tests.plugins.scenario_writer.forgeries import CODED, FORGED, U

TIGHT = Limits(cpu_s=1, wall_s=20.0, memory_mb=300)
BRIEF = Limits(cpu_s=1, wall_s=4.0, memory_mb=300)
EXAMPLE = re.findall(r"```python\n(.*?)```", (settings.PROMPTS / "code.md").read_text(), re.DOTALL)[0]
SLEEPS = ("sleep", "closed answer")


@pytest.fixture
def bait(tmp_path, monkeypatch):
    """A secret to read, a place to write, a port to call, and a look at what came of it.

    Its processes carry a mark in their command lines, which forks keep: other tests may run scripts meanwhile.
    """
    mark = f"# of {tmp_path}"
    monkeypatch.setattr(script_runner, "_BOOT", f"{script_runner._BOOT}\n{mark}")
    secret, canary = tmp_path / "secret.txt", tmp_path / "canary.txt"
    secret.write_text("the-secret")
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0)
        words = {"secret": str(secret), "canary": str(canary), "port": str(server.getsockname()[1])}
        yield lambda source: re.sub(r"\{(secret|canary|port)\}", lambda m: words[m[1]], source)
        with pytest.raises(BlockingIOError, match="unavailable"):
            server.accept()
    assert secret.read_text() == "the-secret"
    assert not canary.exists()
    assert not left_running(mark)


def running(mark):
    """Processes with a word in their command lines, this one's children or not."""
    return [p for p in psutil.process_iter(["cmdline"]) if mark in " ".join(p.info["cmdline"] or ())]


def left_running(mark):
    """Processes with the word that do not end: on a busy machine the end of a killed one takes its time."""
    return psutil.wait_procs(running(mark), timeout=10.0)[1]


def test_a_script_that_runs_is_seen_by_its_mark(tmp_path, monkeypatch):
    monkeypatch.setattr(script_runner, "_BOOT", f"{script_runner._BOOT}\n# of {tmp_path}")
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(
            run_script, "import time\ntime.sleep(60)\n", dataclasses.replace(TIGHT, wall_s=2.0), unchecked=True
        )
        while not running(f"# of {tmp_path}"):
            assert not waiting.done(), "it ended unseen"
            time.sleep(0.01)
    assert not left_running(f"# of {tmp_path}")


def test_there_are_a_hundred_attempts():
    assert len(RULED) + len(RAW) >= 100


@pytest.mark.parametrize("name", spread(RULED, 4))
def test_an_attempt_is_stopped(bait, name):
    ran = run_script(bait(RULED[name]), TIGHT)
    assert ran.xosc is None
    assert ran.fault is not None
    assert ran.fault.kind != "NoScenario", "it ran to its end"
    assert "the-secret" not in f"{ran}"


@pytest.mark.parametrize("name", spread(RAW, 3))
def test_the_walls_hold_without_the_rules(bait, name):
    started = time.monotonic()
    ran = run_script(bait(RAW[name]), BRIEF if name in SLEEPS else TIGHT, unchecked=True)
    assert not ran.xosc
    assert ran.fault.kind != "Found", "the script got hold of something"
    assert "the-secret" not in f"{ran}"
    assert time.monotonic() - started < 25


def _breached(source):
    try:
        return breaches(parsed(source))
    except SyntaxError:
        return ["no Python"]


def test_no_text_becomes_code_or_a_private_name():
    """What the rules let pass runs, all in one script: each attempt fails, and the script lives to its end."""
    passing = [source.removeprefix(U) for source in CODED.values() if not _breached(source)]
    assert len(CODED) >= 300
    assert 100 < len(passing) < len(CODED)
    bodies = [
        f"def attempt{i}():\n{textwrap.indent(source, '    ')}\n    return found\n"
        f"try:\n    held = attempt{i}()\nexcept Exception:\n    pass\nelse:\n    print({i}, held)\n"
        for i, source in enumerate(passing)
    ]
    ran = run_script(U + "".join(bodies) + "print('ended')\n" + EXAMPLE)
    assert ran.fault is None
    assert ran.printed == "ended\n"


def test_an_enumeration_of_the_scripts_own_works():
    own = (
        "from enum import Enum, IntEnum, auto\nclass A(Enum):\n    x = auto()\n    y = 2\nprint(A(2).name, A.x.value)\n"
    )
    assert run_script(own + EXAMPLE).printed == "y 1\n"


@pytest.fixture(scope="module")
def walls():
    """The walls around an honest script."""
    return run_script(EXAMPLE).walls


@pytest.mark.parametrize("name", FORGED)
def test_nobody_answers_in_the_sandboxs_place(name, walls):
    ran = run_script(FORGED[name], TIGHT, unchecked=True)
    assert not ran.xosc
    assert "forged" not in f"{ran}"
    assert ran.walls == walls, "a script said which walls stand"


def test_a_scripts_process_holds_no_secret_and_no_channel_to_the_project():
    """With every builtin at hand: the frames above it, and the descriptors that are open."""
    walk = (
        "import re, sys\nframe, seen = sys._getframe(), []\nwhile frame:\n"
        "    seen += [frame.f_locals, frame.f_globals]\n    frame = frame.f_back\n"
        "found = [k for m in seen for k, v in m.items() if re.search('secret|token', k)]\n"
        "found += re.findall('[0-9a-f]{32}', str(seen))\nfound = found or ''"
    )
    assert run_script(walk, TIGHT, unchecked=True).fault.kind == "Nothing"
    channels = (
        "import os\nfound = []\nfor k in range(64):\n    try:\n        os.fstat(k)\n        found.append(k)\n"
        "    except OSError:\n        pass"
    )
    assert run_script(channels, TIGHT, unchecked=True).fault.message == "[1, 2]", "its own pipe, and the error stream"


def test_what_a_script_says_is_taken_as_a_scenario_or_as_nothing():
    say = 'import json, os\nos.write(1, json.dumps({{"ok": True, "xosc": {!r}}}).encode())\nos._exit(0)'
    own = "<?xml version='1.0'?>\n<OpenSCENARIO></OpenSCENARIO>"
    assert run_script(say.format(own), TIGHT, unchecked=True).xosc == own
    for other in ("the-secret", "<forged/>", "<?xml version='1.0'?><OpenSCENARIOS/>", ""):
        assert run_script(say.format(other), TIGHT, unchecked=True).fault.kind == "ForgedAnswer"


def test_an_honest_script_comes_back_as_a_scenario():
    ran = run_script("print('hello')\n" + EXAMPLE)
    assert ran.fault is None
    assert ran.xosc is not None
    assert '<ScenarioObject name="V1">' in ran.xosc
    assert ran.printed == "hello\n"


def test_all_walls_stand_here():
    ran = run_script(EXAMPLE)
    if "namespaces" not in ran.walls:
        pytest.skip("this system gives no user namespaces")
    assert ran.walls == ("namespaces", "root", "calls")


def test_writing_the_file_is_harmless_since_scripts_end_with_it():
    assert run_script(EXAMPLE + "\nscenario.write_xml('/tmp/x.xosc')\n").fault is None


@pytest.mark.parametrize(("script", "layer", "kind", "line"), [
    ("x = (\n", "parse", "SyntaxError", 1),
    ("x = 1\ny = x / 0\n", "execution", "ZeroDivisionError", 2),
    ("from scenariogeneration import xosc\n\nxosc.Nothing()", "execution", "AttributeError", 3),
    ("x = 1", "execution", "NoScenario", None),
    ("scenario = 3", "execution", "NoScenario", None),
    ("class E(Exception):\n    def __str__(self):\n        return 1 / 0\nraise E()", "execution", "E", 4),
])  # fmt: skip
def test_a_fault_names_its_layer_kind_and_line(script, layer, kind, line):
    fault = run_script(script).fault
    assert (fault.layer, fault.kind, fault.line) == (layer, kind, line)


def test_a_forbidden_script_is_not_run_and_all_its_breaches_are_told():
    fault = run_script("import os\nimport numpy as np\nx = open('f')\n").fault
    assert fault.layer == "rules"
    assert [(b[0], b[2]) for b in fault.breaches] == [(1, "os"), (2, "numpy"), (3, "open")]


def test_a_scripts_own_private_attributes_are_its_own():
    own = "class A:\n    def __init__(self):\n        self._x = 1\n    def x(self):\n        return self._x\nA().x()\n"
    assert run_script(own + EXAMPLE).fault is None


@pytest.fixture
def no_namespaces(monkeypatch):
    """A system that lets nobody unshare, as seen from inside."""
    denied = "import plugins.scenario_writer.sandbox.isolation as c; c.isolate = lambda channels: False; "
    monkeypatch.setattr(script_runner, "_BOOT", script_runner._BOOT.replace("from plugins", f"{denied}from plugins", 1))


def test_without_a_namespace_nothing_runs_unless_it_is_allowed(no_namespaces):
    with pytest.raises(ConfigError, match=r"network namespace.*allow_without_namespace: true"):
        run_script(EXAMPLE)
    ran = run_script(EXAMPLE, allow_without_namespace=True)
    assert ran.fault is None
    assert "namespaces" not in ran.walls


@pytest.mark.parametrize("name", ["read a secret", "fork", "socket by ctypes", "write a file"])
def test_without_a_namespace_the_other_walls_hold(no_namespaces, bait, name):
    if "calls" not in run_script(EXAMPLE, allow_without_namespace=True).walls:
        pytest.skip("no system call filter for this machine")
    ran = run_script(bait(RAW[name]), TIGHT, allow_without_namespace=True, unchecked=True)
    assert ran.fault.kind != "Found"
