"""Checks of the traffic control of an OpenDRIVE file: signals without lanes, stop lines without signals, ...

Beyond the schema (double ids, controllers without signals): every signal reaches lanes that exist and drive its way,
one that governs a junction holds for lanes that lead into it, every head has a controller, every stop line a signal.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from sgcad_core.case.records import Finding
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.opendrive.controls import SIGNS, is_head
from sgcad_core.formats.opendrive.furniture import STOP_LINE
from sgcad_core.formats.opendrive.geometry import number
from sgcad_core.formats.xml import Element

_finding = FindingFactory("opendrive")

BESIDE_M = 1e-6
_DRIVEN = ("driving", "bidirectional", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "restricted", "stop")


def control_findings(root: Element) -> list[Finding]:
    """Faults of signals, stop lines and controllers; the schema must hold."""
    signals = [(road, s) for road in root.iterfind("road") for s in road.iterfind("signals/signal")]
    objects = {str(o.get("id")): (road, o) for road in root.iterfind("road") for o in road.iterfind("objects/object")}
    into = _lanes_into_junctions(root)
    return [
        *_names(signals),
        *(fault for road, signal in signals for fault in _signal(road, signal, into)),
        *_references(signals, objects),
        *_stop_lines(signals, objects),
        *_controllers(root, [s for _, s in signals]),
    ]


def _names(signals: Sequence[tuple[Element, Element]]) -> Iterator[Finding]:
    for name in (str(s.get("id")) for _, s in signals):
        if not name.isdigit():
            yield _finding("a signal's id is no number", "signal", name, "number the signals: readers expect it")


MOST_LANES = 1000


def lanes_of(element: Element) -> set[int]:
    """Lane ids of the <validity> elements of a signal or an object."""
    return {
        lane
        for entry in element.iterfind("validity")
        for lane in range(_lane(entry, "fromLane"), _lane(entry, "toLane") + 1)
        if lane != 0
    }


def _lane(entry: Element, name: str) -> int:
    """A lane's number; beyond MOST_LANES no road has one, and a file may say any."""
    return int(max(-MOST_LANES, min(MOST_LANES, number(entry, name))))


# ------------------------------------------------------------------ signals
def _signal(road: Element, signal: Element, into: Mapping[tuple[str, str], set[int]]) -> Iterator[Finding]:
    where = f"signal {signal.get('id')} on road {road.get('id')}"
    if not -BESIDE_M <= number(signal, "s") <= number(road, "length") + BESIDE_M:
        yield _finding("stands beyond its road", where, signal.get("s"), f"the road is {road.get('length')} m long")
    held, way = lanes_of(signal), signal.get("orientation")
    if not held:
        yield _finding("holds for no lane", where, "", "add a <validity>")
    driven = {int(number(e, "id")) for e in road.iterfind("lanes/laneSection/*/lane") if e.get("type") in _DRIVEN}
    if missing := held - driven:
        yield _finding("holds for lanes that are not there", where, sorted(missing), f"lanes are {sorted(driven)}")
    if wrong := {lane for lane in held if (lane > 0) == (way == "+")} if way in ("+", "-") else set():
        yield _finding("holds for lanes that drive the other way", where, sorted(wrong), "turn its orientation")
    if signal.get("type") in SIGNS or is_head(signal):
        end = "end" if way == "+" else "start"
        if lost := held - into.get((str(road.get("id")), end), set()):
            yield _finding("holds for lanes that lead into no junction", where, sorted(lost), "put it at a junction")


def _lanes_into_junctions(root: Element) -> dict[tuple[str, str], set[int]]:
    """(road, its end) -> lanes that a junction leads on."""
    inner = {str(road.get("id")): road for road in root.iterfind("road") if road.get("junction") != "-1"}
    found: dict[tuple[str, str], set[int]] = {}
    for connection in root.iterfind("junction/connection"):
        road = inner.get(str(connection.get("connectingRoad")))
        side = "predecessor" if connection.get("contactPoint") == "start" else "successor"
        link = None if road is None else road.find(f"link/{side}")
        if link is not None:
            lanes = {int(number(entry, "from")) for entry in connection.iterfind("laneLink")}
            found.setdefault((str(link.get("elementId")), str(link.get("contactPoint"))), set()).update(lanes)
    return found


# ------------------------------------------------------------------ what belongs together
def _references(
    signals: Sequence[tuple[Element, Element]], objects: Mapping[str, tuple[Element, Element]]
) -> Iterator[Finding]:
    known = {"signal": {str(s.get("id")) for _, s in signals}, "object": set(objects)}
    for _, signal in signals:
        for link in signal.iterfind("reference"):
            kind, name = str(link.get("elementType")), str(link.get("elementId"))
            if name not in known.get(kind, set()):
                yield _finding(
                    f"refers to no {kind} of the file", f"signal {signal.get('id')}", name, f"add the {kind}"
                )


def _stop_lines(
    signals: Sequence[tuple[Element, Element]], objects: Mapping[str, tuple[Element, Element]]
) -> Iterator[Finding]:
    """Every stop line belongs to signals of its road that hold for all of its lanes."""
    for name, (road, line) in objects.items():
        if line.get("subtype") != STOP_LINE:
            continue
        where = f"stop line {name} on road {road.get('id')}"
        mine = [
            s
            for r, s in signals
            if r is road and s.find(f"reference[@elementType='object'][@elementId='{name}']") is not None
        ]
        held = set[int]().union(*(lanes_of(s) for s in mine))
        if not mine:
            yield _finding("a stop line belongs to no signal", where, name, "let a signal refer to it, or leave it out")
        elif lost := lanes_of(line) - held:
            yield _finding("a stop line crosses lanes that no signal stops", where, sorted(lost), "widen the validity")


def _controllers(root: Element, signals: Sequence[Element]) -> Iterator[Finding]:
    heads = {str(s.get("id")) for s in signals if is_head(s)}
    led = {str(c.get("signalId")) for c in root.iterfind("controller/control")}
    used = {str(c.get("id")) for c in root.iterfind("junction/controller")}
    there = {str(c.get("id")) for c in root.iterfind("controller")}
    for head in sorted(heads - led):
        yield _finding("a signal head has no controller", f"signal {head}", "", "name it in a <controller>")
    for name in sorted(used - there):
        yield _finding("a junction names a controller that is not there", "junction", name, "add the controller")
    for name in sorted(there - used):
        yield _finding("a controller belongs to no junction", f"controller {name}", "", "name it in its <junction>")
