"""Calls of a plugin held to its kind's interface: what it does wrong is told as its own fault.

The methods that a kind declares are wrapped where a plugin class is made, so that every caller is told the same. What a
method may return is its annotation in interfaces.py. Knows classes and annotations; no kind.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, get_args, get_origin, get_type_hints

from sgcad_core.entry_points import name_of
from sgcad_core.errors import PluginFault, SgcadError

REMEDY = "mend that plugin: docs/plugins.md says what each kind returns"


def hold_to_interface(cls: type, interface: type) -> None:
    """Wrap the methods of a plugin class that override those of its kind."""
    for name, method in list(vars(cls).items()):
        declared = getattr(interface, name, None)
        if inspect.isfunction(method) and inspect.isfunction(declared) and not name.startswith("_"):
            expected = get_type_hints(declared)["return"]
            loose = expected is type(None) or float in get_args(expected)  # ignored, or an int will do
            setattr(cls, name, _held(method, Any if loose else expected))


def _held(method: Callable[..., Any], expected: Any) -> Callable[..., Any]:
    @functools.wraps(method)
    def call(plugin: Any, *args: Any, **kwargs: Any) -> Any:
        with held(plugin, method.__name__):
            found = method(plugin, *args, **kwargs)
        if expected is not Any and not fits(found, expected):
            raise fault_of(plugin, f"{method.__name__} returned {_told(found)}, expected {_named(expected)}")
        return found

    return call


@contextmanager
def held(plugin: Any, what: str) -> Iterator[None]:
    """Tells what a plugin's object raises as the plugin's fault. `what`: the call, in words."""
    try:
        yield
    except SgcadError:
        raise
    except (Exception, SystemExit) as fault:
        raise fault_of(plugin, f"{what} raised {type(fault).__name__}: {fault!s:.300}") from fault


def fault_of(plugin: Any, what: str) -> PluginFault:
    """The error of a plugin that broke its interface."""
    cls = type(plugin)
    where = f"{cls.kind} {name_of(cls, cls.kind)!r} ({cls.__module__}:{cls.__qualname__})"
    return PluginFault(f"{where}: {what}; {REMEDY}")


def fits(value: object, expected: Any) -> bool:
    """Whether a value is of an annotation: a class, a union, or a list or tuple of classes."""
    kind, inner = get_origin(expected), get_args(expected)
    if kind in (list, tuple):
        return isinstance(value, kind) and all(isinstance(one, inner[0]) for one in value)
    return isinstance(value, expected)


def _told(value: object) -> str:
    if isinstance(value, list | tuple):
        kinds = sorted({type(one).__name__ for one in value}) or ["nothing"]
        return f"a {type(value).__name__} of {', '.join(kinds)}"
    shown = f" {value!r:.80}" if isinstance(value, str | int | float) else ""
    return "None" if value is None else f"{type(value).__name__}{shown}"


def _named(expected: Any) -> str:
    inner = [getattr(one, "__name__", "...") for one in get_args(expected)]
    if get_origin(expected) in (list, tuple):
        return f"{get_origin(expected).__name__}[{', '.join(inner)}]"
    return " or ".join(inner) or str(getattr(expected, "__name__", expected))
