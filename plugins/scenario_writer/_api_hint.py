"""The entry of scenariogeneration's API that an exception is about: the nearest name, with its signature.

Reads the installed package by introspection, in our process: names and signatures only, nothing is called.
"""

from __future__ import annotations

import difflib
import inspect
import re
from functools import cache
from typing import Any

_MODULE = re.compile(r"module 'scenariogeneration(?:\.xosc)?' has no attribute '(\w+)'|has no such name here.*?(\w+)")
_MEMBER = re.compile(r"(?:type object )?'(\w+)'(?: object)? has no attribute '(\w+)'")
_CALL = re.compile(r"(\w+)(?:\.(\w+))?\(\) (?:got|missing|takes)")
_UNDEFINED = re.compile(r"name '(\w+)' is not defined")
_USED = re.compile(r"xosc\.(\w+)")


@cache
def names() -> dict[str, Any]:
    """Public classes and functions of scenariogeneration.xosc by name."""
    from scenariogeneration import xosc

    return {n: v for n, v in vars(xosc).items() if not n.startswith("_") and (inspect.isclass(v) or callable(v))}


def nearest_entry(kind: str, message: str, source_line: str) -> str:
    """The entry to use instead, such as "xosc.TransitionDynamics(shape, dimension, value)"; "" if none is near."""
    if found := _MODULE.search(message) or _UNDEFINED.search(message):
        return _named(found[1] or found[found.lastindex or 1])
    if found := _MEMBER.search(message):
        return _member(found[1], found[2])
    if kind == "AttributeError" and message.isidentifier():  # an enumeration names the lacking member only
        owner = re.search(rf"(\w+)\.{message}\b", source_line)
        return _member(owner[1], message) if owner else ""
    if found := _CALL.search(message):
        return _called(found[1], found[2] or "__init__")
    used = [name for name in _USED.findall(source_line) if name in names()]
    return signature(used[0]) if used else ""


def signature(name: str, method: str = "") -> str:
    """A class (or one of its methods) as it is called: names and defaults of its parameters."""
    item = names()[name]
    shown = f"xosc.{name}" + (f".{method}" if method else "")
    if not method and (members := _members(item)) and not _takes_arguments(item):
        return f"{shown}: {', '.join(members)}"
    try:
        parameters = list(inspect.signature(getattr(item, method or "__init__")).parameters.values())
    except (TypeError, ValueError):
        return shown
    return f"{shown}({', '.join(_parameter(p) for p in parameters if p.name != 'self')})"


def _named(name: str) -> str:
    if name in names():
        return f"{signature(name)}, written with xosc."
    return "; ".join(signature(n) for n in difflib.get_close_matches(name, names(), 2, 0.6))


def _member(owner: str, name: str) -> str:
    if owner not in names():
        return ""
    known = [n for n in dir(names()[owner]) if not n.startswith("_")]
    near = difflib.get_close_matches(name, known, 3, 0.4)
    if members := _members(names()[owner]):
        return f"xosc.{owner}: {', '.join(near or members)}"
    return "; ".join(_method(owner, n) for n in near)


def _method(owner: str, name: str) -> str:
    found = getattr(names()[owner], name)
    return signature(owner, name) if inspect.isfunction(found) else f"xosc.{owner}.{name}"


def _called(owner: str, method: str) -> str:
    if owner not in names():
        return ""
    return signature(owner) if method == "__init__" else signature(owner, method)


def _members(item: Any) -> list[str]:
    """Members of an enumeration; scenariogeneration's are classes whose attributes are its own enum type."""
    from scenariogeneration.xosc.enumerations import _OscEnum

    return [n for n, v in vars(item).items() if isinstance(v, _OscEnum)] if inspect.isclass(item) else []


def _takes_arguments(item: Any) -> bool:
    return "__init__" in vars(item)


def _parameter(parameter: inspect.Parameter) -> str:
    default = parameter.default
    if default is inspect.Parameter.empty:
        return str(parameter).split(":")[0]
    return f"{parameter.name}={default if isinstance(default, int | float | str | None) else '...'}"
