"""A written family in lines for people, from its manifest.json and, where a driver was searched, its hardest.json."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flows.case_files.case_folder import read_json
from sgcad_core.rules.records import WORDS

SHOWN = 3
"""Parameters that are named: those that decide most."""


def family_lines(place: Path) -> list[str]:
    """The folder, the number of members, and how the driver did with them."""
    told = read_json(place / "manifest.json")
    lines = [f"{told['case']}: {told['count']} members that crash as declared, of {told['drawn']} that were drawn"]
    if hard := read_json(place / "hardest.json"):
        lines += _driver_lines(hard)
    return [*lines, f"results: {place}"]


def _driver_lines(hard: Mapping[str, Any]) -> list[str]:
    who = f"{hard['driver']} drives {hard['ego']} ({hard['role']})"
    lines = [f"{who}: touches in {_share(hard['contact_rate'])}, breaks a rule in {_share(hard['rule_rate'])}"]
    lines += [f"hardest: {_member(one)}" for one in hard["hardest"][:1]]
    lines += [f"hardest by rules: {_member(one)}" for one in hard["hardest_by_rules"][:1]]
    most = sorted(hard["decides"].items(), key=lambda pair: -abs(pair[1]))[:SHOWN]
    return lines + ([f"what decides (rank correlation): {', '.join(f'{n} {v:+.2f}' for n, v in most)}"] if most else [])


def _share(rate: float | None) -> str:
    return "an unknown share of them" if rate is None else f"{100 * min(rate, 1.0):.0f} % of them"


def _member(one: Mapping[str, Any]) -> str:
    """What comes of a member, and which rules the driver breaks in it."""
    hardness = one["hardness"]
    met = f"delta-v {hardness:.1f} m/s" if hardness > 0 else f"no contact, {-hardness:.1f} m clear"
    broken = ", ".join(WORDS.get(rule, rule) for rule in one["rules"])
    return f"{one['outcome']}, {met}" + (f"; {broken}" if broken else "")
