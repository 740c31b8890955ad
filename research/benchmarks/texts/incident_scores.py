"""Measures of one run against the coded fields of an incident report: which actors met, where, in which maneuvers.

The subject of a report is actor V1; the other actor has an id of the coded kind (a vehicle V, a pedestrian P, a cyclist
B, an animal A, an object O). Contacts, areas and maneuvers are those of the trajectories, the junction that of
road.net.xml; of what a run says of itself only the status and the sizes of its actors are believed. Codes flag damage,
so each of several areas may be the right one, and a corner is either of its sides. Knows no narrative.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flows.case_files.case_folder import read_trajectories
from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.execution.contact import first_with
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Size, wrap_angle
from sgcad_core.roads.lane_graph import network_figures

SUBJECT = "V1"
MEASURES = ("generated", "actors", "contact", "subject_manoeuvre", "other_manoeuvre", "areas", "intersection", "whole")
_LETTERS: Mapping[str, str] = {"pedestrian": "P", "cyclist": "B", "animal": "APO", "object": "OTV"}
_SILENT = ("the text gives no account of the crash", "the account of the crash is blacked out")
"""Words of refusals of reports from which nobody could draw a crash."""
_STANDS_MPS, _STANDS_M = 0.5, 1.0
_STRAIGHT_DEG, _TURN_DEG, _ACROSS_DEG = 30.0, 10.0, 60.0
_BACK_M, _ACROSS_M = 0.3, 0.7


@dataclass(frozen=True)
class Run:
    """What a case's folder holds; without motion there are no tracks."""

    status: str
    tracks: Mapping[str, Trajectory]
    sizes: Mapping[str, Size]
    junctions: int
    silent: bool = False
    """Whether it was refused because its report gives no account of a crash, or one that was blacked out."""

    @staticmethod
    def of(folder: Path) -> Run:
        """Read a folder; one that lacks files is a run without them."""
        file = folder / "result.json"
        result: dict[str, Any] = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        sizes = {a["id"]: (float(a["length_m"]), float(a["width_m"])) for a in result.get("actors", ())}
        motion, net = folder / "trajectories.csv", folder / "road.net.xml"
        known = read_trajectories(motion) if motion.exists() and result.get("status") == "generated" else ()
        tracks = {track.actor: track for track in known if track.actor in sizes}
        drawn = network_figures(parse_net(net.read_text(encoding="utf-8"))) if net.exists() else None
        silent = any(words in str(result.get("reason")) for words in _SILENT)
        return Run(str(result.get("status", "none")), tracks, sizes, drawn.intersections if drawn else 0, silent)

    def meeting(self) -> ObservedContact | None:
        """The subject's first contact with any actor."""
        if SUBJECT not in self.tracks:
            return None
        others = [track for name, track in self.tracks.items() if name != SUBJECT]
        return first_with(self.tracks[SUBJECT], others, self.sizes)


def scores(run: Run, truth: Mapping[str, Any]) -> dict[str, bool]:
    """The measures that the codes of a report allow to judge."""
    letters = _LETTERS.get(truth["other"]["kind"], "V")
    hit = run.meeting()
    met, mine, theirs = _seen(hit)
    fitting = [name for name in run.tracks if name != SUBJECT and name[0] in letters]
    partner = met if met in fitting else next(iter(fitting), None)
    made = run.status == "generated" and bool(run.tracks)
    found = {
        "generated": made,
        "actors": SUBJECT in run.tracks and bool(fitting),
        "contact": made and (hit is not None) == truth["contact"] and (met is None or met[0] in letters),
    }
    until = hit.t_s if hit else math.inf
    for field, name in (("subject", SUBJECT), ("other", partner)):
        verdict = shows(truth[field]["manoeuvre"], run.tracks.get(name or ""), until)
        if verdict is not None:
            found[f"{field}_manoeuvre"] = verdict
    told = truth["subject"]["areas"], truth["other"]["areas"]
    if truth["contact"] and all(told) and letters == "V":
        found["areas"] = _fits(mine, told[0]) and _fits(theirs, told[1])
    if truth["road"].get("intersection"):
        found["intersection"] = run.junctions > 0
    return found | {"whole": all(found.values())}


def false_success(run: Run, truth: Mapping[str, Any]) -> bool:
    """A contact that is told, none that came about, and a status that says all is well."""
    return bool(truth["contact"]) and run.status == "generated" and run.meeting() is None


def _seen(hit: ObservedContact | None) -> tuple[str | None, str, str]:
    """The actor that the subject met, and the areas of both."""
    if hit is None:
        return None, "", ""
    if hit.actor == SUBJECT:
        return hit.other, hit.actor_area, hit.other_area
    return hit.actor, hit.other_area, hit.actor_area


def _fits(area: str, coded: list[str]) -> bool:
    return any(area in code.split("_") for code in coded)


def shows(manoeuvre: str | None, track: Trajectory | None, until_s: float) -> bool | None:
    """Whether a track up to a time shows a coded maneuver; None: that maneuver is not judged."""
    judged = {"stopped", "parked", "straight", "backing", "turn_left", "turn_right", "u_turn", "lane_change"}
    if manoeuvre not in judged:
        return None
    last = int(np.searchsorted(track.t_s, until_s, side="right")) if track is not None else 0
    if track is None or last < 2:
        return False
    x, y, h = (np.asarray(values)[:last] for values in (track.x_m, track.y_m, track.heading_rad))
    moved = math.hypot(x[-1] - x[0], y[-1] - y[0])
    along = float(np.sum(np.diff(x) * np.cos(h[:-1]) + np.diff(y) * np.sin(h[:-1])))
    across = abs(-(x[-1] - x[0]) * math.sin(h[0]) + (y[-1] - y[0]) * math.cos(h[0]))
    turned = math.degrees(float(np.sum(wrap_angle(np.diff(h)))))
    stands = float(track.speed_mps[last - 1]) < _STANDS_MPS or moved < _STANDS_M
    verdicts = {
        "stopped": stands, "parked": stands, "backing": along < -_BACK_M,
        "straight": moved >= _STANDS_M and abs(turned) < _STRAIGHT_DEG and along > 0,
        "turn_left": turned > _TURN_DEG, "u_turn": turned > _TURN_DEG, "turn_right": turned < -_TURN_DEG,
        "lane_change": across > _ACROSS_M and abs(turned) < _ACROSS_DEG,
    }  # fmt: skip
    return verdicts[manoeuvre]
