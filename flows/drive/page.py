"""drive.html: the script and the drive in one player, one over the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flows.player import player_page
from flows.player.player_data import COLORS, Mover, View
from flows.player.road_shapes import drawing_of
from sgcad_core.case.records import CrashReport, Execution
from sgcad_core.handover.drive import Drive
from sgcad_core.result import CaseRecord
from sgcad_core.rules.judge import broken
from sgcad_core.rules.records import RuleFinding

SCRIPT = "script"
"""Name of the script among the player's runs."""


def page(driven: Drive, told: Mapping[str, Any]) -> str:
    """The page as text: the drive, and over it in dashes the script."""
    infos = {a.id: a for a in driven.staging.script.actors}
    movers = (
        Mover(infos[t.actor], t, COLORS[k % len(COLORS)]) for k, t in enumerate(driven.trajectories) if t.actor in infos
    )
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
    return View(record, report, metrics, result, drawing_of(script.net_xml), movers, runs, name, SCRIPT)


def _words(told: Mapping[str, Any]) -> str:
    """The result in sentences."""
    lines = [f"{told['driver']} drives {told['ego']}, the {told['role']}: {told['outcome']} ({told['reason']})."]
    if told["braked_s"] is not None:
        ttc = told["braked_at_ttc_s"]
        at = f" at a time to collision of {ttc:.2f} s" if ttc is not None else ""
        lines.append(f"It began to brake {told['braked_s']:.2f} s before that{at}.")
    could = told.get("avoidance") or {}
    if could.get("brake_by_s") is not None:
        lines.append(
            f"Against the script, full braking had to begin {could['brake_by_s']:.2f} s "
            f"({could['brake_by_m']:.1f} m) before the contact."
        )
    if could.get("steer_by_s") is not None:
        lines.append(f"Moving aside to the {could['steer_to']} had to begin {could['steer_by_s']:.2f} s before it.")
    lines.append(f"Least clearance {told['closest_m']:.2f} m. Dashed: the script.")
    found = [RuleFinding.model_validate(one) for one in told["rules"]]
    kept = f"{told['ego']} broke no traffic rule that the map tells of."
    lines += [f"{f.words()}." for f in broken(found)] or [kept]
    return " ".join(lines)
