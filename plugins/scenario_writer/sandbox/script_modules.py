"""The modules that a script can import: fronts that hold public names only, made before the process is confined.

A front prevents a script from reaching other modules through a module's own imports. scenariogeneration's xosc is
loaded without its package's __init__ and without the schema library, which is not needed: 0.1 s instead of 0.8 s.
Everything that turns a text into a name or into code is left out: dataclasses (which compile source made of field
names), enumerations made by a call, and the library's parsers (which read attributes named in a file).
"""

from __future__ import annotations

import builtins
import enum
import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
from types import ModuleType
from typing import Any

from plugins.scenario_writer.sandbox.script_rules import ANY, BUILTINS, MODULES

_LIBRARY = "scenariogeneration"
_UNUSED = ("xmlschema", "lxml", "lxml.etree", "venv")
"""Modules that xosc imports for reading and pretty-printing files, which a script does not do."""
MAX_PRINTED = 20_000


class TooMuchPrinted(Exception):
    """The script floods its output."""


def fronts(site: str) -> Mapping[str, ModuleType]:
    """Every importable module by name; `site` is the folder that holds scenariogeneration."""
    xosc = _xosc(site)
    made = {
        name: _front(name, importlib.import_module(name), allowed)
        for name, allowed in MODULES.items()
        if not name.startswith(_LIBRARY)
    }
    made["enum"].Enum, made["enum"].IntEnum = Enum, IntEnum  # type: ignore[attr-defined]
    made[f"{_LIBRARY}.xosc"] = xosc
    made[_LIBRARY] = ModuleType(_LIBRARY)
    made[_LIBRARY].xosc = xosc  # type: ignore[attr-defined]
    made[_LIBRARY].prettyprint = _nothing  # type: ignore[attr-defined]
    return made


def _front(name: str, module: ModuleType, allowed: frozenset[str]) -> ModuleType:
    front = ModuleType(name)
    for key, value in vars(module).items():
        if not key.startswith("_") and (allowed is ANY or key in allowed) and not isinstance(value, ModuleType):
            setattr(front, key, value)
    return front


def _xosc(site: str) -> ModuleType:
    """A front of scenariogeneration.xosc whose classes write no files."""
    for unused in _UNUSED:
        sys.modules[unused] = _Unused(unused)
    package = ModuleType(_LIBRARY)
    package.__path__ = [f"{site}/{_LIBRARY}"]
    sys.modules[_LIBRARY] = package
    xosc = importlib.import_module(f"{_LIBRARY}.xosc")
    for name, module in list(sys.modules.items()):
        if name.startswith(_LIBRARY) and hasattr(module, "os"):
            del module.os
    for item in vars(xosc).values():
        for method in ("write_xml", "parse"):
            if isinstance(item, type) and hasattr(item, method):
                setattr(item, method, _nothing)
    own = {n for n, v in vars(xosc).items() if str(getattr(v, "__module__", "")).startswith(_LIBRARY)}
    return _front(f"{_LIBRARY}.xosc", xosc, frozenset(own))


class _Unused(ModuleType):
    """Stands in for a module of which xosc reads names while it is imported, and no more."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return None


class _Written(enum.EnumType):
    """Enumerations whose members stand in a class body: names made by a call may be anything, private ones too."""

    def __call__(cls, value: object, *more: object, **fields: object) -> Any:
        """The member of a value. Raises TypeError where names are given as well."""
        if more or fields:
            raise TypeError("write an Enum as a class with its members")
        return super().__call__(value)


class Enum(enum.Enum, metaclass=_Written):
    """A script's Enum."""


class IntEnum(enum.IntEnum, metaclass=_Written):
    """A script's IntEnum."""


def _nothing(*args: object, **kwargs: object) -> None:
    return None


# ------------------------------------------------------------------ builtins
def script_builtins(modules: Mapping[str, ModuleType], printed: list[str]) -> dict[str, Any]:
    """The builtins of a script: computing ones, a bounded print, an import that knows `modules` alone."""
    known = {name: getattr(builtins, name) for name in BUILTINS}
    return known | {
        "__build_class__": builtins.__build_class__,
        "__import__": _importer(modules),
        "print": _printer(printed),
    }


def _importer(modules: Mapping[str, ModuleType]) -> Callable[..., ModuleType]:
    def load(
        name: str, globals_: object = None, locals_: object = None, fromlist: Sequence[str] | None = (), level: int = 0
    ) -> ModuleType:
        if level or name not in modules:
            raise ImportError(f"module {name!r} is not available here")
        return modules[name] if fromlist else modules[name.split(".")[0]]

    return load


def _printer(printed: list[str]) -> Callable[..., None]:
    room = [MAX_PRINTED]

    def write(*values: object, sep: str | None = " ", end: str | None = "\n", **_: object) -> None:
        text = (" " if sep is None else sep).join(map(str, values)) + ("\n" if end is None else end)
        room[0] -= len(text)
        if room[0] < 0:
            raise TooMuchPrinted(f"the script prints more than {MAX_PRINTED} characters")
        printed.append(text)

    return write
