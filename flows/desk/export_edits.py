"""`sgcad desk export RUNS --out DIR`: cases corrected by people, as data.

    pairs.jsonl          one line per corrected case: report, facts with reasons, the specs as read and as corrected
    truth/<case>.json    the corrected case as a label, for `sgcad score`
    rows.jsonl           one line per corrected case for training: narrative, drawing, layout and behavior

Only cases with a person's fact are exported: the others were not checked. Reads run folders; starts nothing.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flows.case import person_facts
from flows.case_files import case_folder
from sgcad_core.errors import BadInput, ConfigError, SgcadError
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.records.edits import Edit, effective
from sgcad_core.records.specs import BehaviorSpec, Road, RoadSpec
from sgcad_core.revision import read_edits
from sgcad_core.revision.spec_to_layout import layout_of
from sgcad_core.revision.values import bearing_of, hub_of, legs_of, value_of
from sgcad_core.roads.lane_graph import network_figures
from sgcad_core.system.report_files import facts_file


@dataclass(frozen=True)
class Mended:
    """A finished case with a person's facts."""

    folder: Path
    result: Mapping[str, Any]
    specs: person_facts.Specs
    road: RoadSpec
    behavior: BehaviorSpec
    edits: tuple[Edit, ...]

    @property
    def case(self) -> str:
        """The case's id."""
        return str(self.result["case"])

    @property
    def narrative(self) -> str:
        """The report's text as the writers had it."""
        return (self.folder / "report.txt").read_text(encoding="utf-8")


def export(runs: Path, out: Path) -> list[str]:
    """Write pairs, truth and rows of one config's corrected cases; lines on what was written.

    Raises BadInput where there is no result or no corrected case; ConfigError where `out` cannot be written.
    """
    if not any(runs.glob("*/result.json")):
        raise BadInput(f"{runs}: no <case>/result.json in it; give the folder of one config, such as runs/template")
    left: list[str] = []
    found = list(mended(runs, left))
    if not found:
        raise BadInput(
            f"{runs}: no fact of these cases was changed by a person, so nothing to export; see `sgcad revise`"
        )
    try:
        _write(found, out)
    except OSError as fault:
        raise ConfigError(f"{out}: cannot be written ({fault.strerror}); choose another folder") from fault
    facts = sum(case.result["person"]["facts"] for case in found)
    wrong = sum(case.result["person"]["disagreed"] for case in found)
    head = f"{len(found)} mended cases with {facts} facts by people, of which {wrong} were read otherwise: {out}"
    return [head, *left]


def mended(runs: Path, left: list[str]) -> Iterator[Mended]:
    """Generated cases with a person's facts and both specs; `left` gets a line for each of the others."""
    for file in sorted(runs.glob("*/result.json")):
        folder = file.parent
        result = case_folder.CaseFolder(runs.parent, runs.name, folder.name).result() or {}
        if not (result.get("person") or {}).get("facts"):
            continue
        try:
            specs, edits = person_facts.read_specs(folder), _edits(folder)
        except SgcadError as fault:
            left.append(f"left out: {fault}")
            continue
        if result["status"] != "generated" or specs.road is None or specs.behavior is None:
            left.append(f"left out: {folder.name} is {result['status']}: mend it further")
            continue
        yield Mended(folder, result, specs, specs.road, specs.behavior, edits)


def _edits(folder: Path) -> tuple[Edit, ...]:
    """The facts beside the report of a case; () where the report was moved: the values are in the result."""
    try:
        source = person_facts.report_path(folder)
    except BadInput:
        return ()
    return effective(read_edits(facts_file(source)))


def _write(found: Iterable[Mended], out: Path) -> None:
    (out / "truth").mkdir(parents=True, exist_ok=True)
    with (
        (out / "pairs.jsonl").open("w", encoding="utf-8") as pairs,
        (out / "rows.jsonl").open("w", encoding="utf-8") as rows,
    ):
        for case in found:
            case_folder.write_json(out / "truth" / f"{case.case}.json", label(case))
            pairs.write(json.dumps(pair(case), ensure_ascii=False) + "\n")
            rows.write(json.dumps(row(case, out), ensure_ascii=False) + "\n")


# ------------------------------------------------------------------ pairs and rows
def pair(case: Mended) -> dict[str, Any]:
    """A case as read and as corrected, JSON-able."""
    was = case.specs.as_read or {}
    return {
        "case": case.case,
        "config": case.result["config"],
        "narrative": case.narrative,
        "facts": [edit.model_dump(mode="json") for edit in case.edits],
        "read": {"road": was.get("road"), "behavior": was.get("behavior"), "values": case.result["person"]["read"]},
        "mended": {"road": case.road.model_dump(mode="json"), "behavior": case.behavior.model_dump(mode="json")},
    }


def row(case: Mended, out: Path) -> dict[str, Any]:
    """A case as a training row: the evidence and both answers. `layout` is null where no hub has all roads.

    The drawing is copied to `out`/drawings and named relative to `out`.
    """
    layout = layout_of(case.road)
    return {
        "case": case.case,
        "narrative": case.narrative,
        "drawing": _drawing(case, out),
        "layout": layout.model_dump(mode="json") if layout else None,
        "road": case.road.model_dump(mode="json"),
        "behavior": case.behavior.model_dump(mode="json"),
    }


def _drawing(case: Mended, out: Path) -> str | None:
    drawn = case.folder / "diagram.png"
    if not drawn.is_file():
        return None
    (out / "drawings").mkdir(exist_ok=True)
    shutil.copyfile(drawn, out / "drawings" / f"{case.case}.png")
    return f"drawings/{case.case}.png"


# ------------------------------------------------------------------ truth
def label(case: Mended) -> dict[str, Any]:
    """The corrected case as a truth file: network, vehicles, events and conditions."""
    behavior = case.behavior
    return {
        "case": case.case,
        "source": "people",
        "network": _network(case),
        "vehicles": [_vehicle(case, actor.id) for actor in behavior.actors],
        "events": [
            {"kind": "collision", "actor": c.striker, "other": c.struck, "actor_area": c.striker_area,
             "other_area": c.struck_area}
            for c in behavior.contacts
        ],
        "conditions": {name: getattr(behavior, name) for name in ("light", "weather", "surface")},
        "by_person": sorted(case.result["person"]["read"]),
    }  # fmt: skip


def _network(case: Mended) -> dict[str, Any]:
    spec = case.road
    figures = network_figures(parse_net((case.folder / "road.net.xml").read_text(encoding="utf-8")))
    legs = {leg.id for leg in legs_of(spec)}
    return {
        "nodes": [{"id": n.id, "x_m": n.x_m, "y_m": n.y_m} for n in spec.nodes],
        "segments": [_segment(road, spec, road.id in legs) for road in spec.roads],
        "intersections": figures.intersections,
        "components": figures.components,
        "control": hub_of(spec).control,
        "layout_best": value_of("junction.kind", spec, None),
    }


def _segment(road: Road, spec: RoadSpec, is_leg: bool) -> dict[str, Any]:
    return {
        "id": road.id, "from": road.from_node, "to": road.to_node,
        "compass": bearing_of(road, spec) if is_leg else None,
        "lanes_towards_to": road.lanes_forward, "lanes_towards_from": road.lanes_backward,
        "twltl": road.center_turn_lane, "median": road.median != "none", "curved": bool(road.via),
        "speed_limit_mph": road.speed_limit_mph,
    }  # fmt: skip


def _vehicle(case: Mended, name: str) -> dict[str, Any]:
    group = "vehicles" if name.startswith("V") else "others"
    names = {"type": "kind", "initial_heading": "heading", "manoeuvre": "maneuver", "initial_segment": "start_road",
             "initial_lane": "start_lane", "speed_mph": "speed_mph"}  # fmt: skip
    found = {label: value_of(f"{group}.{name}.{field}", case.road, case.behavior) for label, field in names.items()}
    return {"id": name} | found
