"""scenariogeneration's API as chunks, read from the installed package by introspection.

One chunk for each public class, function or enumeration of `xosc` and `xodr`: signature, docstring with parameters,
public methods. Imports the library at the first call (0.5 to 1 s). Knows no database.
"""

from __future__ import annotations

import enum
import importlib
import inspect
import re
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

from plugins.retriever.knowledge.chunk import Chunk, Task

MODULES: dict[str, tuple[Task, ...]] = {"xosc": ("scenario",), "xodr": ("road",)}
_HELPERS = ("get_", "convert_", "enum", "are_", "is_", "find_", "merge_")
"""Prefixes of functions that only the package itself uses."""
_DULL = {"parse", "get_element", "get_attributes", "get_header"}
_NOISE = (
    (re.compile(r"scenariogeneration(\.\w+)*\.|typing\.|datetime\.(?=datetime)"), ""),
    (re.compile(r"ForwardRef\('([^']*)'\)"), r"\1"),
    (re.compile(r"Union\[([\w.]+), NoneType\]|Optional\[([\w.]+)\]"), r"\1\2 | None"),
    (re.compile(r"<[\w.]+ object at 0x[0-9a-f]+>"), "..."),
    (re.compile(r"<(\w+\.\w+): [^>]*>"), r"\1"),
    (re.compile(r"\bself, |\(self\)|'"), lambda m: "()" if m[0] == "(self)" else ""),
)
_SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\s*$", re.MULTILINE)


def api_chunks() -> Iterator[Chunk]:
    """Chunks of every public name, in alphabetical order."""
    source = f"scenariogeneration {version('scenariogeneration')}"
    for short, tasks in MODULES.items():
        module = importlib.import_module(f"scenariogeneration.{short}")
        for name, item in sorted(vars(module).items()):
            own = getattr(item, "__module__", "").startswith("scenariogeneration")
            if not own or name.startswith(("_", *_HELPERS)):
                continue
            if text := _text(f"{short}.{name}", item):
                yield Chunk(
                    id=f"api/{short}.{name}", kind="api", tasks=tasks, title=f"{short}.{name}", text=text,
                    keywords=_lead(item), source=source,
                )  # fmt: skip


def _text(name: str, item: Any) -> str:
    if values := _values(item):
        return f"enumeration {name}: {_lead(item)}\nvalues: {', '.join(f'{name}.{v}' for v in values)}"
    if inspect.isclass(item):
        return "" if issubclass(item, Exception) else _class(name, item)
    return f"function {signature(name, item)}\n{_doc(item)}" if inspect.isfunction(item) else ""


def _values(item: Any) -> list[str]:
    """Members of an enumeration; xosc's are plain classes whose attributes are the values."""
    if not inspect.isclass(item):
        return []
    if issubclass(item, enum.Enum):
        return list(item.__members__)
    return [k for k, v in vars(item).items() if type(v).__name__ == "_OscEnum"]


def _class(name: str, item: type) -> str:
    methods = [_method(k, v) for k, v in vars(item).items() if inspect.isfunction(v) and _worth(k)]
    parts = [f"class {signature(name, item)}", _doc(item)]
    return "\n".join([*parts, *(["methods:", *methods] if methods else [])])


def _worth(method: str) -> bool:
    return not method.startswith("_") and method not in _DULL


def _method(name: str, function: Any) -> str:
    return f"  .{signature(name, function)}: {_lead(function)}".rstrip(": ")


def signature(name: str, item: Any) -> str:
    """`name(parameters) -> type` without the package's paths and memory addresses."""
    try:
        text = str(inspect.signature(item))
    except (TypeError, ValueError):  # built in C
        text = "(...)"
    for pattern, plain in _NOISE:
        text = pattern.sub(plain, text)
    return name + text.removesuffix(" -> None")


def _lead(item: Any) -> str:
    """The first paragraph of a docstring, on one line."""
    return " ".join((inspect.getdoc(item) or "").split("\n\n")[0].split())


def _doc(item: Any) -> str:
    """The docstring's text with its parameters and return value, without what the signature shows."""
    pieces = _SECTION.split(inspect.getdoc(item) or "")
    sections = dict(zip(pieces[1::2], pieces[2::2], strict=True))
    kept = [" ".join(pieces[0].split())]
    for title in ("Parameters", "Returns"):
        if body := _squeezed(sections.get(title, "")):
            kept.append(f"{title.lower()}:\n{body}")
    return "\n".join(kept)


def _squeezed(body: str) -> str:
    """`name : type` and its text on one line each."""
    lines: list[str] = []
    for line in filter(str.strip, body.splitlines()):
        if line[0].isspace() and lines:
            lines[-1] += ("; " if " : " in lines[-1] and ";" not in lines[-1] else " ") + line.strip()
        else:
            lines.append(f"  {line.strip()}")
    return "\n".join(lines)
