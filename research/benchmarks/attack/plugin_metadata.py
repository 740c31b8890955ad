"""Packages of other people: entry points, metadata and modules that are damaged, huge, misleading or hostile."""

from __future__ import annotations

import contextlib
import importlib
import io
import random
import sys
from collections.abc import Iterator
from pathlib import Path

from research.benchmarks.fuzz.making import NUMBERS, changed

NAME = "plugin metadata"
KINDS = ("driver", "decoder", "road_writer", "validator", "nokind", "", "tracker")
MARK = "import sys; sys.attacked = True\n"
MODULES: tuple[bytes, ...] = (
    b"class Plug: ...\n", b"", b"raise RuntimeError\n", b"import sys; sys.exit(3)\n", b"\xff\xfe\x00", b"def Plug(: ",
    b"x = " + b"-" * 200_000 + b"1\n", b"x = " + b"(" * 50_000, b"x = a" + b".a" * 50_000, b"class " + b"P" * 100_000,
    b"from x import *\n", b"Plug = 1\n", b"'" * 99_999, b"\\\n" * 50_000, b"if 1:\n" + b" " * 2_000_000,
    b"x = '\\d'\nclass Plug: ...\n", b"# coding: utf-7\nclass Plug: ...\n", b"lambda: " * 20_000,
)  # fmt: skip
VALUES = (
    "{m}.inner:Plug", "{m}.inner", "{m}.inner:", ":Plug", "{m}:Plug.inner.more", "{m}.inner:Plug [extra]",
    "a." * 3000 + "b:C",
    "..inner:Plug", "{m}.inner:(a+)+$", "no module at all", "{m}.inner:Plug\x00", "os:system", "{m}.inner : Plug",
    "\u202e:x",
    "{m}/inner:Plug", "../../etc/passwd:Plug", "{m}.inner:Pl\u00fcg", "builtins:print", "sys:exit", "__main__:x",
)  # fmt: skip


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Folders with one or two installed packages."""
    for number in range(10**9):
        (site := folder / f"site-{number}").mkdir()
        for one in range(rng.choice((1, 1, 2))):
            _package(rng, site, f"attack{number}x{one}")
        yield site


def _package(rng: random.Random, site: Path, name: str) -> None:
    (site / name).mkdir()
    (site / name / "__init__.py").write_text(MARK, encoding="utf-8")
    (site / name / "inner.py").write_bytes(rng.choice(MODULES))
    info = site / f"{name}-{rng.choice(('1.0', 'x', '', '1.0-2'))}.{rng.choice(('dist-info', 'dist-info', 'egg-info'))}"
    info.mkdir()
    (info / rng.choice(("METADATA", "METADATA", "PKG-INFO"))).write_bytes(_metadata(rng, name))
    (info / "entry_points.txt").write_bytes(_points(rng, name))
    if rng.random() < 0.1:
        (info / rng.choice(("RECORD", "top_level.txt", "direct_url.json"))).write_bytes(rng.randbytes(300))


def _metadata(rng: random.Random, name: str) -> bytes:
    whole = f"Metadata-Version: 2.1\nName: {rng.choice((name, name, '', '../x', 'x' * 9000))}\nVersion: 1.0\n"
    return rng.choice((whole.encode(), changed(whole, rng), rng.randbytes(200), b"", b"\xff\xfe\x00" * 50))


def _points(rng: random.Random, name: str) -> bytes:
    lines = []
    for _ in range(rng.choice((1, 2, 5, 300))):
        if rng.random() < 0.4:
            lines.append(f"[sgcad.{rng.choice(KINDS)}]")
        key = rng.choice(("plug", "x" * 5000, "", "\x1b[31mred", "a b", "[", "auto", "=", *NUMBERS))
        lines.append(f"{key} {rng.choice(('=', '=', '=', '', ':', '=='))} {rng.choice(VALUES).replace('{m}', name)}")
    whole = "\n".join(["[sgcad.driver]", *lines])
    return changed(whole, rng) if rng.random() < 0.4 else whole.encode("utf-8", "surrogatepass")


def feed(item: Path) -> None:
    """List the plugins with these packages on the path. Raises AssertionError where one of them was imported."""
    from flows.plugin_commands import plugins_list
    from sgcad_core import entry_points

    sys.path.insert(0, str(item))
    try:
        importlib.invalidate_caches()
        entry_points.read.cache_clear()
        entry_points.distribution.cache_clear()
        with contextlib.redirect_stdout(io.StringIO()) as shown:
            plugins_list()
    finally:
        sys.path.remove(str(item))
    if hasattr(sys, "attacked"):
        del sys.attacked
        raise AssertionError("a package was imported to list it")
    if "aeb" not in shown.getvalue() or "\x1b" in shown.getvalue():
        raise AssertionError("the list lacks our own plugins, or sends escapes to the terminal")
