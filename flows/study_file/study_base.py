"""What a study makes of its base (`extends: OTHER.yaml`), and of the config that it names for all its arms.

    title: Alpha sensitivity, Llama-3.2-90B
    extends: alpha_qwen72b.yaml
    config: paper/llama90b_sg_cadvlm.yaml     # of every arm and of the cross product that name none
    arms:
      - {name: greedy, published: null}       # an arm of the base is changed key by key; a new name is a new arm

Works on a YAML's mapping before it is checked.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sgcad_core import config_extends


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The base with the changes made: keys as in a config, arms by their names."""
    found = config_extends.merged(base, changes)
    if _listed(base.get("arms")) and _listed(changes.get("arms")):
        found["arms"] = _arms(base["arms"], changes["arms"])
    return found


def _listed(arms: Any) -> bool:
    """Whether these are arms with names; other faults are told when the whole is checked."""
    return isinstance(arms, list) and all(isinstance(a, dict) and isinstance(a.get("name"), str) for a in arms)


def _arms(base: list[dict[str, Any]], changes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    held = {arm["name"] for arm in base}
    changed: dict[str, dict[str, Any]] = {}
    new = []
    for arm in changes:
        if arm["name"] in held - set(changed):
            changed[arm["name"]] = arm
        else:
            new.append(arm)  # a name given twice stands twice, which is told
    return [*(config_extends.block(arm, changed.get(arm["name"], {})) for arm in base), *new]


def give_config(raw: Mapping[str, Any]) -> None:
    """Give the study's `config` to every arm, and to the cross product, that names none."""
    config, arms, cross = raw.get("config"), raw.get("arms"), raw.get("cross")
    if config is None:
        return
    for arm in arms if isinstance(arms, list) else ():
        if isinstance(arm, dict):
            arm.setdefault("config", config)
    if isinstance(cross, dict) and "config" not in (cross.get("over") or {}):
        cross.setdefault("config", config)
