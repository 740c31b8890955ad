"""The sandbox's two processes, both confined: one reads and runs a script, the other hands on what it says.

The script must leave an `xosc.Scenario` in its variable `scenario`. No part of the script is parsed before the
confinement is in place. The channel to the project is open in the second process alone, in which no line of a script
runs: what the first one says is taken as the script's word, a scenario or a fault, whatever wrote it. There is no
secret that a script could read. Runs once and ends; knows nothing of the project.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import sys
import traceback
import xml.etree.ElementTree as ET
from types import ModuleType
from typing import Any

from plugins.scenario_writer.sandbox import isolation
from plugins.scenario_writer.sandbox.script_modules import fronts, script_builtins
from plugins.scenario_writer.sandbox.script_rules import breaches, parsed

Json = dict[str, Any]
MAX_XML = 5_000_000
MAX_SAID = 16_000_000
RECURSION = 400


def main(site: str, status: int) -> None:
    """Runs the job on standard input, then ends. `status` is the descriptor that reports the confinement."""
    job: Json = json.loads(sys.stdin.buffer.read())
    os.close(0)
    own = isolation.isolate((1, 2, status))
    if not own and not job["allow_without_namespace"]:
        _tell(status, isolated=False)
        os._exit(0)
    modules = fronts(site)
    walls = {"namespaces": own, "root": own and isolation.shut_in(job["folder"])}
    heard, said = os.pipe()
    if child := isolation.split():
        for channel in (said, status):
            os.close(channel)
        _hand_on(child, heard, job)
    os.dup2(said, 1)
    for channel in (heard, said):
        os.close(channel)
    isolation.limit(job["cpu_s"], job["memory_mb"])
    walls["calls"] = isolation.filter_calls()
    _tell(status, isolated=True, walls=[name for name, up in walls.items() if up])
    printed: list[str] = []
    try:
        answer = _unchecked(job["source"]) if job["unchecked"] else _run(job["source"], modules, printed)
    except BaseException as fault:  # noqa: BLE001 - whatever a script raises is its answer
        answer = _fault(fault)
    _write(1, json.dumps({**answer, "printed": _short("".join(printed), 2000)}).encode())
    os._exit(0)  # at once: no finalizer of the script runs


# ------------------------------------------------------------------ the process that hands on
def _hand_on(script: int, heard: int, job: Json) -> None:
    """Reads what the script's process says, waits for its end, hands on a scenario or a fault; ends likewise."""
    isolation.limit(job["cpu_s"], job["memory_mb"])
    isolation.filter_calls(waits=True)
    said = bytearray()
    while len(said) <= MAX_SAID and (piece := os.read(heard, 1 << 16)):
        said += piece
    if len(said) > MAX_SAID:
        _write(1, bytes(said))  # more than is taken there, too
        os._exit(0)
    ended = os.waitpid(script, 0)[1]
    if os.WIFSIGNALED(ended) or not said:
        os._exit(128 + os.WTERMSIG(ended) if os.WIFSIGNALED(ended) else os.WEXITSTATUS(ended))
    _write(1, _taken(bytes(said)))
    os._exit(0)


def _taken(said: bytes) -> bytes:
    """The answer anew, if it is one; else an empty one. What begins otherwise than a scenario is none."""
    try:
        answer = json.loads(said)
    except (ValueError, RecursionError, MemoryError):
        return b"{}"
    if not isinstance(answer, dict) or (answer.get("ok") and not _SCENARIO.match(str(answer.get("xosc")))):
        return b"{}"
    return json.dumps(answer).encode()


_SCENARIO = re.compile(r"<\?xml[^<>]{0,99}\?>\s{0,9}<OpenSCENARIO[\s>]")


# ------------------------------------------------------------------ the process that runs the script
def _tell(status: int, **what: object) -> None:
    """Reports the confinement and closes the channel, so that nothing that runs later can report it again."""
    _write(status, json.dumps(what).encode())
    os.close(status)


def _run(source: str, modules: dict[str, ModuleType] | Any, printed: list[str]) -> Json:
    sys.setrecursionlimit(RECURSION)
    try:
        tree = parsed(source)
    except (SyntaxError, MemoryError, RecursionError, ValueError) as fault:
        line = getattr(fault, "lineno", None)
        message = _short(fault.msg if isinstance(fault, SyntaxError) else str(fault) or "nested too deeply", 600)
        return {"ok": False, "layer": "parse", "kind": type(fault).__name__, "message": message, "line": line}
    if found := breaches(tree):
        told = [[line, *(_short(words, 600) for words in about)] for line, *about in found[:12]]
        return {"ok": False, "layer": "rules", "breaches": told}
    space: Json = {"__builtins__": script_builtins(modules, printed), "__name__": "__main__"}
    exec(compile(tree, "<scenario>", "exec"), space)  # noqa: S102 - what this process is for
    return _result(space, modules["scenariogeneration.xosc"])


def _unchecked(source: str) -> Json:
    """Runs with every builtin and module, to test the confinement without the rules."""
    space: Json = {"__name__": "__main__"}
    exec(compile(source, "<scenario>", "exec"), space)  # noqa: S102 - what this process is for
    found = _short(str(space.get("found", "")), 600)
    return {"ok": False, "layer": "execution", "kind": "Found" if found else "Nothing", "message": found}


def _result(space: Json, xosc: ModuleType) -> Json:
    scenario = space.get("scenario")
    if not isinstance(scenario, xosc.Scenario):
        found = type(scenario).__name__ if "scenario" in space else "nothing"
        message = f"the name `scenario` must be bound to an xosc.Scenario, found {found}"
        return {"ok": False, "layer": "execution", "kind": "NoScenario", "message": message}
    root = scenario.get_element()
    ET.indent(root)
    text = '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
    text = _sendable(text)
    if len(text) > MAX_XML:
        message = f"the scenario has {len(text)} characters, at most {MAX_XML} are taken"
        return {"ok": False, "layer": "execution", "kind": "TooLarge", "message": message}
    return {"ok": True, "xosc": text}


def _fault(fault: BaseException) -> Json:
    """Type, words and the script's own line of an exception."""
    line = None
    with contextlib.suppress(Exception):
        frames = traceback.extract_tb(fault.__traceback__)
        line = next((f.lineno for f in reversed(frames) if f.filename == "<scenario>"), None)
    message = ""
    with contextlib.suppress(Exception):
        message = _short(str(fault), 600)
    return {
        "ok": False, "layer": "execution", "kind": _short(type(fault).__name__, 80), "message": message, "line": line,
    }  # fmt: skip


def _sendable(text: str) -> str:
    """The text with its lone surrogates, which no UTF-8 can carry, as question marks."""
    return text.encode("utf-8", "replace").decode("utf-8")


def _short(text: str, limit: int) -> str:
    text = _sendable(text)
    return text if len(text) <= limit else f"{text[: limit - 3]}..."


def _write(channel: int, text: bytes) -> None:
    data = memoryview(text)
    while data:
        data = data[os.write(channel, data) :]
