"""SUMO's netconvert as a process: plain XML in, road network out.

Nothing in the plain XML is trusted: the schema is checked first (negative lane numbers crash netconvert),
and a crash of its own is a result, not an exception. A kill or a full disk says nothing of
the network and is an exception: the case fails, and is tried again. Knows no plugin.
"""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path

from sgcad_core import settings
from sgcad_core.case.records import PlainXml, RoadNetwork
from sgcad_core.errors import ConfigError, InvalidOutput, ProcessDied, SimulationFailed
from sgcad_core.formats.opendrive.write import write_xodr
from sgcad_core.formats.sumo.plain_xml import xsd_findings
from sgcad_core.records.specs import RoadSpec
from sgcad_core.system.subprocess_limits import ended_from_outside, run_limited
from sgcad_core.system.temp_folders import temp_folder

TIMEOUT_S = 60.0
LEAST_FREE = 1 << 20
"""Bytes in the temporary folder below which a failure is the disk's; a network takes some 0.1 MB."""
MAP_MEMORY_MB, MAP_FILE_MB = 16_000, 4_000
"""Of a user's map: a city of a million people takes 6 GB."""
REMEMBERED = 6
"""Networks that a process keeps, half a megabyte each."""
_compiled: dict[tuple[str, PlainXml, RoadSpec | None], RoadNetwork] = {}
XSD_RETURNCODE = 1
"""As netconvert's own for input that it refuses."""
FLAGS = (
    "--offset.disable-normalization",  # the frame of the spec stays the frame of the network
    "--output.original-names",
    "--no-turnarounds",
    "--precision", "6",
    "-X", "local",
)  # fmt: skip


def compile_network(plain: PlainXml, spec: RoadSpec | None = None) -> RoadNetwork:
    """Compile plain XML to .net.xml and valid OpenDRIVE, about 0.1 s.

    Bad content leaves net_xml and xodr None, `log` says why and `returncode` is not 0 (negative: the
    signal netconvert died of; 124: it took longer than 60 s). Raises MissingTool, SimulationFailed (killed, disk full).
    The last few networks are kept, since an edit of an actor leaves the network as it is.
    """
    if findings := xsd_findings(plain):
        log = "\n".join(f.line() for f in findings)
        return RoadNetwork(plain=plain, spec=spec, log=log, returncode=XSD_RETURNCODE)
    key = (str(settings.netconvert()), plain, spec)
    found = _compiled.pop(key, None) or _compile(plain, spec)
    if found.returncode == 0:
        _compiled[key] = found
        for oldest in list(_compiled)[:-REMEMBERED]:
            _compiled.pop(oldest, None)
    return found


def _compile(plain: PlainXml, spec: RoadSpec | None) -> RoadNetwork:
    with temp_folder("net") as folder:
        code, said = _run(plain, folder)
        net = _read(folder / "road.net.xml")
    log = _without_closed(said, spec)
    if code != 0 or not net:
        return RoadNetwork(plain=plain, spec=spec, log=log or "netconvert wrote no network", returncode=code or 1)
    try:
        xodr = write_xodr(net)
    except InvalidOutput as fault:
        return RoadNetwork(plain=plain, spec=spec, net_xml=net, log=f"{log}\n{fault}".strip(), returncode=1)
    return RoadNetwork(plain=plain, spec=spec, net_xml=net, xodr=xodr, log=log, returncode=code)


def _without_closed(said: str, spec: RoadSpec | None) -> str:
    """netconvert's words without those on lanes that a work zone closes: nothing leads into them."""
    ways = [(f"{sign}{r.id}", shut) for r in (spec.roads if spec else ())
            for sign, shut in (("", r.closed_forward), ("-", r.closed_backward))]  # fmt: skip
    closed = tuple(f"Lane '{edge}_" for edge, shut in ways if shut)
    lines = said.splitlines()
    return "\n".join(line for line in lines if not ("is not connected" in line and any(c in line for c in closed)))


def _run(plain: PlainXml, folder: Path) -> tuple[int, str]:
    arguments = [*FLAGS, "-o", "road.net.xml"]
    for flag, name in (("-n", "nodes"), ("-e", "edges"), ("-x", "connections")):
        if text := getattr(plain, name):
            (folder / f"{name}.xml").write_text(text, encoding="utf-8")
            arguments += [flag, f"{name}.xml"]
    return _call(arguments, folder)


def _call(arguments: Sequence[str], folder: Path) -> tuple[int, str]:
    environment = settings.subprocess_environment()
    try:
        done = run_limited([str(settings.netconvert()), *arguments], folder, environment, TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return 124, f"netconvert took longer than {TIMEOUT_S:g} s"
    _check_left_alone(done.returncode, folder)
    said = (done.stderr + b"\n" + done.stdout).decode("utf-8", "replace")
    return done.returncode, "\n".join(line for line in map(str.strip, said.splitlines()) if line)


def _check_left_alone(code: int, folder: Path) -> None:
    """Raise ProcessDied where netconvert was ended from outside, SimulationFailed where it had no room to write."""
    if ended_from_outside(code):
        raise ProcessDied(
            f"netconvert was ended by {signal.Signals(-code).name}, from outside or for want of memory: see to memory "
            "and run again",
            from_outside=True,
        )
    if code and shutil.disk_usage(folder).free < LEAST_FREE:
        raise SimulationFailed(f"netconvert ended with {code} and {folder.parent} is full: make room and run again")


def _read(file: Path) -> str | None:
    """The file without netconvert's comment (date, paths), so that equal inputs give equal networks."""
    if not file.exists():
        return None
    return re.sub(r"<!--.*?-->\s*", "", file.read_text(encoding="utf-8"), count=1, flags=re.DOTALL)


def plain_files(file: Path, source: Sequence[str], folder: Path, timeout_s: float) -> tuple[Path, Path, Path]:
    """Node, edge and connection file of a user's map, written to `folder`; `source`: netconvert's flags for reading it.

    Raises ConfigError naming the file where netconvert cannot read it or takes longer than `timeout_s`; MissingTool.
    """
    command = [str(settings.netconvert()), *source, "--plain-output-prefix", "map"]
    try:
        environment = settings.subprocess_environment()
        done = run_limited(command, folder, environment, timeout_s, memory_mb=MAP_MEMORY_MB, file_mb=MAP_FILE_MB)
    except subprocess.TimeoutExpired as fault:
        raise ConfigError(f"{file}: netconvert took longer than {timeout_s:g} s; cut the map smaller") from fault
    if done.returncode:
        said = (done.stderr + done.stdout).decode("utf-8", "replace").strip()[-500:]
        raise ConfigError(f"{file}: netconvert cannot read it (exit {done.returncode}): {said}")
    nodes, edges, connections = (folder / f"map.{part}.xml" for part in ("nod", "edg", "con"))
    return nodes, edges, connections
