"""Faults of a configuration in the terms of its YAML: key paths and valid names, no class names.

Knows pydantic's errors; no plugin.
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ValidationError

from sgcad_core.near_names import did_you_mean

YAML_TYPES = {
    "dict_type": "expected a mapping (name: value, one a line)",
    "model_type": "expected a mapping (name: value, one a line)",
    "list_type": "expected a list (- value, one a line)",
    "tuple_type": "expected a list (- value, one a line)",
}
"""Pydantic's errors about Python types, in the terms of YAML."""


def fault_lines(path: str, fault: ValidationError, model: type[BaseModel]) -> list[str]:
    """One line a fault: where in the YAML, what is wrong, the value; for an unknown name the valid ones."""
    return [_line(path, error, model) for error in fault.errors(include_url=False)]


def _line(path: str, error: Any, model: type[BaseModel]) -> str:
    steps = [str(step) for step in error["loc"]]
    place = ".".join(part for part in (path, *steps) if part)
    if error["type"] == "extra_forbidden":
        return f"{place}: {unknown_name('field', steps[-1], _fields(model, steps[:-1]))} (found {error['input']!r})"
    if error["type"] == "missing":
        return f"{place}: missing; this field has no default"
    said = YAML_TYPES.get(error["type"], error["msg"].removeprefix("Value error, ").replace("Input should", "should"))
    return f"{place}: {said} (found {error['input']!r})"


def unknown_name(what: str, name: str, known: list[str]) -> str:
    """The words for a name that is not known: the nearest one, and all."""
    return f"unknown {what}.{did_you_mean(name, known)} Known: {', '.join(sorted(known)) or 'none'}"


def _fields(model: type[BaseModel], steps: list[str]) -> list[str]:
    """Field names of a model, or of the one inside it that the steps lead to; its own where they lead to none."""
    for step in steps:
        field = model.model_fields.get(step)
        inner = field.annotation if field else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            continue
        model = inner
    return [info.alias or name for name, info in model.model_fields.items()]
