"""Cross products: combinations of values, and what an arm made of them is called.

    {decoder.alpha: 0.7, seed: 1}                      alpha_0.7-seed_1
    {config: mini.yaml, report_reader.use_diagrams: false}   mini-use_diagrams_false
    {decoder: {name: cad, alpha: 0.5}}                 cad_alpha_0.5

Pure functions; knows no config.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

import yaml

from flows.case_files.find_cases import safe_id


def combinations(over: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """Every combination of one value a key, the last key changing fastest."""
    for values in itertools.product(*over.values()):
        yield dict(zip(over, values, strict=True))


def name_of(factors: Mapping[str, Any]) -> str:
    """An arm's name, a plain folder name; two combinations with the same name are told as a fault."""
    return safe_id("-".join(_part(key, value) for key, value in factors.items()).replace(" ", "_"))


def label_of(factors: Mapping[str, Any]) -> str:
    """The same for people: "alpha 0.7, seed 1"."""
    return ", ".join(_part(key, value).replace("_", " ") for key, value in factors.items())


def overrides_of(factors: Mapping[str, Any]) -> tuple[str, ...]:
    """The values as `key=value` overrides; the config is none."""
    return tuple(f"{key}={_yaml(value)}" for key, value in factors.items() if key != "config")


def overrides_in(given: Any) -> Any:
    """A mapping as `key=value` overrides; anything else as it is."""
    return tuple(f"{key}={_yaml(value)}" for key, value in given.items()) if isinstance(given, Mapping) else given


def _yaml(value: Any) -> str:
    """A value in one line; a word needs no quotes unless YAML would read something else in it."""
    plain = isinstance(value, str) and value.isidentifier() and yaml.safe_load(value) == value
    return str(value) if plain else json.dumps(value)


def _part(key: str, value: Any) -> str:
    if key == "config":
        return "-".join(PurePath(str(value)).with_suffix("").parts)
    word = _word(value)
    return word if isinstance(value, str | dict) else f"{key.rpartition('.')[2]}_{word}"


def _word(value: Any) -> str:
    if isinstance(value, dict):
        others = (f"{k}_{_word(v)}" for k, v in value.items() if k != "name")
        return "_".join([str(value.get("name", "")), *others]).strip("_")
    if isinstance(value, list | tuple):
        return "_".join(_word(v) for v in value)
    return json.dumps(value) if isinstance(value, bool) or value is None else str(value)
