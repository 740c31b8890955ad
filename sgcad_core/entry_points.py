"""Plugins as the metadata of installed distributions name them; imports none of them.

A distribution's metadata is foreign text: what cannot be read is a line of `unreadable`, never the end of a command.
Knows the names of the kinds; no interface.
"""

from __future__ import annotations

import ast
import sys
import warnings
from collections import defaultdict
from collections.abc import Sequence
from functools import cache, lru_cache
from importlib.machinery import ModuleSpec
from importlib.metadata import Distribution, EntryPoint, distributions
from pathlib import Path

KINDS = (
    "report_reader", "retriever", "backbone", "decoder", "road_writer", "scenario_writer", "validator", "simulator",
    "driver", "tracker",
)  # fmt: skip
GROUP = "sgcad."
DAMAGED = (OSError, ValueError, TypeError, KeyError, AttributeError)
"""What reading damaged metadata raises."""


@cache
def read() -> tuple[dict[str, dict[str, EntryPoint]], tuple[str, ...]]:
    """Entry points of `sgcad.*` groups by kind and name, and a line for each distribution that cannot be read."""
    found = defaultdict[str, list[EntryPoint]](list)
    faults, seen = [], set[str]()
    for one in distributions():
        try:
            if GROUP not in (one.read_text("entry_points.txt") or ""):
                continue
            points = [point for point in one.entry_points if point.group.startswith(GROUP)]
        except DAMAGED as fault:
            faults.append(f"{distribution(one)}: its entry points cannot be read ({fault}): install that package again")
            continue
        if (name := distribution(one)) not in seen:  # a second of this name is hidden by the first, as when importing
            seen.add(name)
            for point in points:
                found[point.group.removeprefix(GROUP)].append(point)
    by_name = {kind: {p.name: p for p in sorted(points, key=lambda p: p.name)} for kind, points in found.items()}
    return by_name, tuple(faults)


def catalogue(kind: str) -> dict[str, EntryPoint]:
    """Installed plugins of a kind by name."""
    return read()[0].get(kind, {})


def unreadable() -> tuple[str, ...]:
    """A line for each distribution whose entry points cannot be read."""
    return read()[1]


@cache
def distribution(one: Distribution | None) -> str:
    """A distribution's name, or its folder where the name cannot be read."""
    try:
        name = one.name if one else None
    except DAMAGED:
        name = None
    return str(name or getattr(one, "_path", "?"))


def name_of(plugin: type, kind: str) -> str:
    """The name under which a class is installed, else the class's own."""
    value = f"{plugin.__module__}:{plugin.__qualname__}"
    return next((name for name, point in catalogue(kind).items() if point.value == value), plugin.__name__)


# ------------------------------------------------------------------ whether an entry point leads somewhere
GONE = "does not exist"
MAX_SOURCE = 1_000_000
"""Characters of a module that is looked at; of a larger one only importing would tell."""


def point_fault(point: EntryPoint) -> str:
    """What is wrong with an entry point, as far as its module's source tells; "" for nothing. Imports nothing."""
    try:
        module, attribute = point.module, (point.attr or "").split(".")[0]
        spec = _spec(module)
    except (*DAMAGED, ImportError):
        return GONE
    if spec is None or not attribute:
        return GONE
    if not (spec.origin and spec.origin.endswith(".py")):
        return ""  # compiled: only importing it would tell
    return _source_fault(Path(spec.origin), attribute)


def _source_fault(file: Path, attribute: str) -> str:
    """What is wrong with a module that should define a name."""
    try:
        about = file.stat()
        if about.st_size > MAX_SOURCE:
            return ""
        wrong, names = _defined(file, about.st_mtime_ns, about.st_size, about.st_ino)
    except DAMAGED as fault:
        return f"cannot be read ({fault})"
    return wrong or ("" if attribute in names else GONE)


@lru_cache(maxsize=1024)
def _defined(file: Path, changed_ns: int, size: int, inode: int) -> tuple[str, frozenset[str]]:
    """What is wrong with a module's source, and the names it defines; hundreds of entry points may lead to one file.

    Raises what DAMAGED names. All but `file` tell one state of it from the next.
    """
    text = file.read_text(encoding="utf-8")
    try:
        with warnings.catch_warnings(action="ignore"):  # of a stranger's source
            tree = ast.parse(text)
    except (*DAMAGED, SyntaxError, RecursionError, MemoryError) as fault:
        return f"is no Python that can be parsed ({type(fault).__name__}: {str(fault)[:100]})", frozenset()
    return "", frozenset(_names(tree))


def _spec(module: str) -> ModuleSpec | None:
    """Where a module is. Unlike `importlib.util.find_spec`, imports no package on the way to it."""
    parts, spec, places = module.split("."), None, None
    for i in range(len(parts)):
        spec = _found(".".join(parts[: i + 1]), places)
        if spec is None:
            return None
        places = list(spec.submodule_search_locations or ())
    return spec


def _found(name: str, places: Sequence[str] | None) -> ModuleSpec | None:
    finders = (getattr(finder, "find_spec", None) for finder in sys.meta_path)
    return next((spec for find in finders if find and (spec := find(name, places)) is not None), None)


def _names(tree: ast.Module) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
    return found
