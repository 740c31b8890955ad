"""The dozen figures to look at first, of the 170 that an arm has: copied to the front of MLflow's lists, explained.

MLflow sorts figures by name, groups charts by what stands before "/", and opens a comparison on the first ones; so the
copies that an arm has are called `0_headline/01_collision_realised` and so on. The figures themselves keep their names.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sgcad_core.case.verdict_told import verdict_sentence

GROUP = "0_headline"
HEADLINE: Mapping[str, str] = {
    "collision_realised": "the told contact is the first one that happens: who, whom, and both areas; more is better",
    "account/whole": "nothing that was found to be told is lacking in the scenario; more is better",
    "account/lacking": "things told that the scenario lacks; less is better",
    "account/told": "things that the report tells, as far as they were read",
    "account/assumed": "things that nobody told and that had to be chosen; less is better",
    "generated": "a scenario was written that does what is declared",
    "refused": "the evidence does not carry a scenario, and it says what lacks; no fault",
    "exhausted": "the attempts ran out before anything held; less is better",
    "failed": "the report cannot be read, or a program died; less is better",
    "near_crash_realised": "a told near crash came as near as declared and nobody touched",
    "exact/collision_speed_mps": "relative speed as the first two boxes meet, m/s",
    "exact/delta_v_worst_mps": "the larger change of velocity of both at the contact, m/s, from their masses",
}
"""Name -> what it means: of a case, and as a mean of an arm's cases."""


def headline(figures: Mapping[str, float]) -> dict[str, float]:
    """Copies of the headline figures that are present, under names that sort first."""
    there = ((number, name) for number, name in enumerate(HEADLINE, 1) if name in figures)
    return {f"{GROUP}/{number:02d}_{name.replace('/', '_')}": figures[name] for number, name in there}


def experiment_note(runs: str) -> str:
    """The description of an experiment: a link to its list of runs, and its headline figures."""
    lines = [f"| `{name}` | {meaning} |" for name, meaning in HEADLINE.items()]
    return "\n".join([
        f"**[All runs]({runs})**: an arm (a config over a set of reports) is a run, its cases are the runs in it; an "
        "arm's figures are means.",
        f"Look at the group `{GROUP}` first; every figure is explained in docs/mlflow.md and docs/metrics.md.", "",
        "| figure | meaning |", "|---|---|", *lines,
    ])  # fmt: skip


def arm_note(config: str, figures: Mapping[str, float]) -> str:
    """The description of an arm: its headline figures with their meanings."""
    rows = [f"| `{name}` | {figures[name]:.4g} | {meaning} |" for name, meaning in HEADLINE.items() if name in figures]
    head = f"**{_plain(config)}** over {figures.get('cases', 0):.0f} cases; figures are means of the cases."
    return "\n".join([head, "", "| figure | mean | meaning |", "|---|---|---|", *rows])


def case_note(case_dir: Path, result: Mapping[str, Any], page: str) -> str:
    """The description of a case: its status, what the scenario lacks, and links. `page` is the run's own address."""
    account = result.get("account") or {}
    lacks = [item["text"] for item in account.get("items") or () if item["kind"] == "lacks"]
    lines = [f"**{_plain(result['status'])}** {_plain(in_words(result).partition(': ')[2])[:500]}".rstrip()]
    if account.get("told"):
        lines += [_plain(said)] if (said := verdict_sentence(result)) else []
        told = f"told {account['told']}, in the scenario {account['has']}, lacking {account['lacking']}, " \
               f"assumed {account['assumed']}"  # fmt: skip
        lines.append(told)
    lines += [f"- lacking: {_plain(text)}" for text in lacks[:10]]
    found = [("report page", f"{page}/artifacts/player.html")] if (case_dir / "player.html").is_file() else []
    found += [(name, link) for name, link in prefect_links(case_dir).items()]
    return "\n\n".join(filter(None, ["\n".join(lines), " · ".join(f"[{name}]({link})" for name, link in found)]))


def in_words(result: Mapping[str, Any]) -> str:
    """A case's end in one line: its status, and the first contact or why there is no scenario."""
    seen, near = (result.get("collision") or {}).get("observed"), (result.get("near_crash") or {}).get("observed")
    if result["status"] != "generated":
        why = str(result.get("reason") or "")
    elif seen and "actor" in seen:
        why = f"the {seen['actor_area']} of {seen['actor']} hits the {seen['other_area']} of {seen['other']} at " \
              f"{seen['t_s']:.1f} s{'' if result['collision']['realised'] else ', which is not as told'}"  # fmt: skip
    elif near:
        why = f"{near['actor']} and {near['other']} come to {near['clearance_m']:.1f} m and do not touch"
    else:
        why = "no contact"
    return f"{result['status']}: {why}" if why else str(result["status"])


def prefect_links(case_dir: Path) -> dict[str, str]:
    """The case's pages in Prefect, from its links.json; complete addresses only."""
    try:
        kept = json.loads((case_dir / "links.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    names = {"Prefect flow run": "prefect", "Prefect task run": "prefect_case"}
    links = {name: str(kept.get(key, "")) for name, key in names.items()} if isinstance(kept, dict) else {}
    return {name: link for name, link in links.items() if re.match(r"https?://[^\s()<>]+$", link)}


def _plain(text: str) -> str:
    """The text with markdown's special characters escaped."""
    return re.sub(r"([\\`*_\[\]<>|#!])", r"\\\1", " ".join(text.split()))
