"""Checks of third-party plugins: the interface of a class, and a fingerprint of the code for cache keys.

Knows classes and files; imports nothing by itself.
"""

from __future__ import annotations

import hashlib
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from pathlib import Path
from typing import get_args, get_type_hints

from pydantic import BaseModel

from sgcad_core import entry_points

OWN = frozenset({"sgcad_core", "plugins", "flows", "research"})
"""Packages whose code and versions are part of every cache key anyway."""
MAX_FILES = 2000
"""Most files of a third-party package in its fingerprint; of a larger one only the plugin's own module."""
STAGES = ("road", "scenario", "both")


def class_faults(found: type[BaseModel], base: type[BaseModel]) -> list[str]:
    """Faults of a plugin class against its kind's interface, each with the line that corrects it."""
    told = [
        f"the method {name!r} is missing: write `def {name}(self, ...)` as {base.__name__} in interfaces.py has it"
        for name in sorted(getattr(found, "__abstractmethods__", ()))
    ]
    for name, hint in get_type_hints(base, include_extras=True).items():
        if hasattr(base, name) or name.startswith("_") or name in base.model_fields:
            continue
        (kind,) = get_args(hint) or (str,)
        value = getattr(found, name, None)
        if isinstance(value, property):
            continue  # told by the fields
        if not isinstance(value, kind) or (name == "stage" and value not in STAGES):
            told.append(f"{name!r} is missing or wrong (found {value!r}): write `{name} = {_example(name, kind)}`")
    return told


def _example(name: str, kind: type) -> str:
    return (
        " or ".join(f'"{stage}"' for stage in STAGES) if name == "stage" else "True or False" if kind is bool else "..."
    )


def code_fingerprint(plugin: type) -> str:
    """Distribution, version and digest of a third-party plugin class and its bases; empty for built-in ones."""
    tops = {base.__module__: None for base in plugin.__mro__ if not _is_ours(base.__module__)}
    return "; ".join(_about(module) for module in tops)


def _is_ours(module: str) -> bool:
    top = module.split(".")[0]
    return top in OWN or top in sys.stdlib_module_names or top in {"pydantic", "builtins"}


@cache
def _about(module: str) -> str:
    top = module.split(".")[0]
    try:
        names = packages_distributions().get(top, [])
        told = f"{names[0]} {version(names[0])}" if names else top
    except (PackageNotFoundError, *entry_points.DAMAGED):
        told = top
    return f"{told} {_digest(module)}"


def _digest(module: str) -> str:
    """Of every Python file of the module's top package, or of the module alone where that is a file or very large."""
    own = getattr(sys.modules.get(module), "__file__", None)
    package = getattr(sys.modules.get(module.split(".")[0]), "__path__", None)
    files = [Path(own)] if own else []
    if package:
        inside = sorted(file for folder in package for file in Path(folder).rglob("*.py"))
        files = inside if len(inside) <= MAX_FILES else files
    found = hashlib.sha256()
    for file in files:
        try:
            found.update(f"{file.name}\n".encode() + file.read_bytes())
        except OSError as fault:
            found.update(str(fault).encode())
    return found.hexdigest()[:16]
