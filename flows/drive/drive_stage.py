"""The stage `drive` of a config: drivers drive an executed case in memory."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from flows.drive.run_drive import FOLDER, Order, drive_script
from flows.drive.script_of_case import roles_of
from sgcad_core.config import DriveStage
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.handover.contact_figures import contact_figures, impact_summary
from sgcad_core.handover.outcome import OUTCOMES
from sgcad_core.handover.rules_of_drive import drive_figures, rules_of_script
from sgcad_core.handover.script import Script
from sgcad_core.result import CaseRecord
from sgcad_core.rules.judge import figures
from sgcad_core.rules.records import RuleFinding

FIGURES = ("braked_s", "braked_at_ttc_s", "hardest_mps2", "closest_m", "least_ttc_s", "pet_s", "lag_s")


def driven(stage: DriveStage, record: CaseRecord, folder: Path) -> dict[str, Any]:
    """Driver -> role -> figures (every outcome 0 or 1), for metrics.json and trackers; files go to drive/."""
    script = script_in(record, stage.role_of)
    order = Order(stage.drivers, roles=stage.roles, release_s=stage.release_s)
    found: dict[str, Any] = {}
    for told in drive_script(script, order, folder / FOLDER):
        found.setdefault(told["driver"], {})[told["role"]] = _figures(told)
    return found


def script_or_none(record: CaseRecord) -> Script | None:
    """An executed case as a script with the roles that were read; None of a case that was not executed."""
    executed = record.scenario and record.execution and record.network and record.network.net_xml
    return script_in(record, {}) if executed else None


def contact(script: Script, record: CaseRecord) -> dict[str, Any]:
    """Figures of the scripted contact: its severity, and the last moments to avoid it."""
    return contact_figures(script, record.execution.contact if record.execution else None)


def impact(script: Script, record: CaseRecord) -> dict[str, Any] | None:
    """Entry of result.json on the scripted contact; None without contact."""
    return impact_summary(script, record.execution.contact if record.execution else None)


class RulesOfCase(NamedTuple):
    """Traffic rules of a case: counts for metrics.json, findings for result.json."""

    counts: dict[str, Any]
    findings: list[dict[str, Any]]


def rules(script: Script) -> RulesOfCase:
    """Traffic rules of the scripted motion, of every actor."""
    found = rules_of_script(script)
    return RulesOfCase(figures(found), [f.model_dump() for f in found])


def script_in(record: CaseRecord, role_of: Mapping[str, str]) -> Script:
    """An executed case as a script. Raises ValueError for one that was not executed."""
    scenario, execution, network = record.scenario, record.execution, record.network
    if not (scenario and execution and network and network.net_xml):
        raise ValueError(f"case {record.case}: nothing was executed")
    facts = [fact.model_dump() for fact in record.reading.facts] if record.reading else []
    return Script(
        case=record.case,
        actors=scenario.actors,
        trajectories=execution.trajectories,
        graph=parse_net(network.net_xml),
        declared=scenario.declared,
        roles=roles_of(facts, role_of),
        surface=scenario.behavior.surface if scenario.behavior else None,
        net_xml=network.net_xml,
        xosc=scenario.xosc,
    )


def _figures(told: Mapping[str, Any]) -> dict[str, Any]:
    now, then = told.get("severity"), told.get("scripted")
    hardness = {"delta_v_mps": _worst(now) if now else 0.0} if told["outcome"] != "failed" else {}
    hardness |= {"scripted_delta_v_mps": _worst(then)} if then else {}
    found = tuple(RuleFinding.model_validate(f) for f in told.get("rules", ()))
    hardness |= drive_figures(found, told["ego"]) if told["outcome"] != "failed" else {}
    outcomes = {o: int(told["outcome"] == o) for o in (*OUTCOMES, "failed")}
    return {"ego": told["ego"], **outcomes, **{n: told[n] for n in FIGURES if told.get(n) is not None}, **hardness}


def _worst(hardness: Mapping[str, Any]) -> float:
    return round(float(max(hardness["first"]["delta_v_mps"], hardness["second"]["delta_v_mps"])), 3)
