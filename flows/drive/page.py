"""drive.html: the script and the drive in one player, one over the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flows.drive.traffic_of_drive import clock_s, replayed
from flows.player import player_page
from flows.player.player_data import COLORS, Mover, View
from flows.player.road_shapes import drawing_of
from flows.player.signals_shown import shown_by
from sgcad_core.case.records import CrashReport, Execution
from sgcad_core.handover.after_contact import with_aftermath
from sgcad_core.handover.drive import Drive
from sgcad_core.result import CaseRecord
from sgcad_core.rules.records import RuleFinding

SCRIPT = "script"
"""Name of the script among the player's runs."""


def page(driven: Drive, told: Mapping[str, Any]) -> str:
    """The page as text: the drive, and over it in dashes the script."""
    infos = {a.id: a for a in driven.staging.script.actors}
    tracks = with_aftermath(driven)
    movers = (Mover(infos[t.actor], t, COLORS[k % len(COLORS)]) for k, t in enumerate(tracks) if t.actor in infos)
    return player_page.page(_view(driven, told, tuple(movers)))


def _view(driven: Drive, told: Mapping[str, Any], movers: tuple[Mover, ...]) -> View:
    script = driven.staging.script
    seen = driven.contact.model_dump() if driven.contact else None
    result = {
        "status": told["outcome"],
        "collision": {"declared": script.declared.model_dump() if script.declared else None,
                      "realised": bool(told["as_declared"]), "observed": seen},
        "network": None, "grounding": {}, "attempts": {"road": 0, "scenario": 0}, "seconds": {},
    }  # fmt: skip
    execution = Execution(simulator="drive", trajectories=driven.trajectories, contact=driven.contact)
    record = CaseRecord(case=script.case, config=f"{told['driver']} drives {told['ego']}", execution=execution)
    report = CrashReport(case=script.case, narrative=_words(told))
    figures = {k: v for k, v in told.items() if isinstance(v, int | float) and not isinstance(v, bool)}
    hard = told.get("severity")
    change = {s["actor"]: round(s["delta_v_mps"], 3) for s in (hard["first"], hard["second"])} if hard else {}
    metrics = {"drive": figures} | ({"exact": {"delta_v_mps": change}} if change else {})
    runs, name = {SCRIPT: script.trajectories}, f"{told['driver']} drives {told['ego']}"
    shown = shown_by(script.lights, clock_s(driven, len(movers[0].track.t_s))) if script.lights else []
    drawing = drawing_of(script.net_xml)
    view = View(record, report, metrics, result, drawing, movers, runs, name, SCRIPT, shown, _told(told))
    return view.among(replayed(driven, len(movers[0].track.t_s)))


def _told(told: Mapping[str, Any]) -> dict[str, Any]:
    """Outcome, reason and rules for the head of the page."""
    found = [RuleFinding.model_validate(one) for one in told["rules"]]
    rows = [{"status": f.status, "ego": f.actor == told["ego"], "text": f.words()} for f in found if f.status != "kept"]
    ego, kept = told["ego"], any(f.status == "kept" and f.actor == told["ego"] for f in found)
    hit = (told.get("traffic") or {}).get("touched") or []
    reason = told["reason"] + (f", but for {', '.join(hit)} of the replayed traffic" if hit else "")
    return {"outcome": told["outcome"], "reason": reason, "doubt": bool(hit), "ego": ego, "kept": kept, "rules": rows}


def _words(told: Mapping[str, Any]) -> str:
    """The result in sentences."""
    lines = [f"{told['driver']} drives {told['ego']}, the {told['role']}: {told['outcome']} ({told['reason']})."]
    if told["braked_s"] is not None:
        ttc = told["braked_at_ttc_s"]
        at = f" at a time to collision of {ttc:.2f} s" if ttc is not None else ""
        end = "the contact" if told["contact"] else "the closest approach"
        lines.append(f"It began to brake {told['braked_s']:.2f} s before {end}{at}.")
    could = told.get("avoidance") or {}
    if could.get("brake_by_s") is not None:
        lines.append(
            f"Against the script, full braking had to begin {could['brake_by_s']:.2f} s "
            f"({could['brake_by_m']:.1f} m) before the contact."
        )
    if could.get("steer_by_s") is not None:
        lines.append(f"Moving aside to the {could['steer_to']} had to begin {could['steer_by_s']:.2f} s before it.")
    if around := told.get("traffic"):
        hit = f"; {told['ego']} touches {', '.join(around['touched'])}" if around["touched"] else ""
        lines.append(f"Gray: {around['vehicles']} vehicles of traffic, replayed: they do not react to the driver{hit}.")
    lines.append(f"Least clearance {told['closest_m']:.2f} m. Dashed: the script.")
    return " ".join(lines)
