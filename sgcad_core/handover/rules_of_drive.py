"""Traffic rules of a script and of a drive: the scenes that the rules look at.

In a drive the signals go with the clock of the others, so that a driver who comes later meets the phase of the script.
Knows scripts and drives; no rule.
"""

from __future__ import annotations

from typing import Any

from sgcad_core.handover.drive import Drive
from sgcad_core.handover.script import Script
from sgcad_core.rules.judge import broken, figures, judge
from sgcad_core.rules.records import RULES, RuleFinding, RuleScene


def rules_of_script(script: Script) -> tuple[RuleFinding, ...]:
    """What every actor of a script breaks, keeps, or what is unknown of it."""
    if not script.graph.edges:
        return ()
    return judge(RuleScene(script.graph, script.trajectories, script.actors, script.lights))


def rules_of_drive(drive: Drive) -> tuple[RuleFinding, ...]:
    """The same of a drive, for every actor in it."""
    script = drive.staging.script
    if not script.graph.edges:
        return ()
    return judge(RuleScene(script.graph, drive.trajectories, script.actors, script.lights, drive.others_s))


def drive_figures(found: tuple[RuleFinding, ...], ego: str) -> dict[str, Any]:
    """Numbers for tables and trackers: rules that the ego broke in all (`rules_broken`), of which nothing is known, and
    of each rule whether."""
    told = figures(found, ego)
    return {"rules_broken": told["broken"], "rules_unknown": told["unknown"]} | {f"broke_{r}": told[r] for r in RULES}


def broken_by(found: tuple[RuleFinding, ...], ego: str) -> tuple[str, ...]:
    """The rules that an actor broke, each once, in the order of the rules."""
    return tuple(dict.fromkeys(f.rule for f in broken(found, ego)))
