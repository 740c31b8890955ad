"""The process that feeds inputs: `python -m research.benchmarks.attack.feeder KIND SEED COUNT SKIP FOLDER`.

A line of JSON on stdout for each input. The process has limits of address space and of file sizes, its temporary
folder, home and caches lie in FOLDER, and what is written elsewhere is told by the interpreter's audit hook.
"""

from __future__ import annotations

import argparse
import json
import logging
import os
import random
import resource
import sys
import tempfile
import traceback
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import IO

import psutil

from research.benchmarks.attack.kinds import kind_of, slow_of
from research.benchmarks.fuzz.trying import heed, within
from sgcad_core.errors import PluginFault, SgcadError

SLOW_BYTES = 100_000
SPARE_MB, FILE_MB = 3000, 1000
"""Address space that an input may take beside what the warm process has, and the largest file that may be written."""
TRACE = b"Traceback (most recent call last)"
Item = Path | bytes | str


@dataclass(frozen=True)
class Fed:
    """What came of one input. `seconds`: of processors, this one's and its children's; `grown_mb`: of memory."""

    number: int
    end: str
    seconds: float = 0.0
    size: int = 0
    grown_mb: float = 0.0
    wrote: str = ""
    said: str = ""
    slow: bool = False
    """Whether it took more processor time than its size allows."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Feed the inputs of one seed, but for the first SKIP."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for words, kind_of_word in (("kind", str), ("seed", str), ("count", int), ("skip", int), ("folder", Path)):
        parser.add_argument(words, type=kind_of_word)
    told = parser.parse_args(arguments)
    name, seed, count, skip, folder = told.kind, told.seed, told.count, told.skip, told.folder
    out = _quiet(folder)
    kind = kind_of(name)
    _warm(kind, folder)
    _limit()
    sys.addaudithook(heed)
    (place := folder / "inputs").mkdir(exist_ok=True)
    items = islice(kind.inputs(random.Random(f"{name} {seed}"), place), count)
    for number, item in enumerate(items):
        if number >= skip:
            out.write(json.dumps(asdict(_fed(kind, number, item, folder))) + "\n")
            out.flush()
        if isinstance(item, Path):
            _remove(item)


def _quiet(folder: Path) -> IO[str]:
    """The true stdout; what anything else prints goes to files in the folder."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    with (folder / "out.log").open("ab") as log:
        os.dup2(log.fileno(), 1)
    tempfile.tempdir = str(folder)
    logging.disable(logging.ERROR)  # libraries tell of every damaged file
    warnings.simplefilter("ignore")
    return out


def _warm(kind: ModuleType, folder: Path) -> None:
    """Feed two inputs that do not count: imports are no input's cost."""
    (place := folder / "warm").mkdir(exist_ok=True)
    for item in islice(kind.inputs(random.Random("warm"), place), 2):
        _ended(kind, item)


def _limit() -> None:
    if sys.platform.startswith("linux"):
        most = psutil.Process().memory_info().vms + (SPARE_MB << 20)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_MB << 20, FILE_MB << 20))


def _fed(kind: ModuleType, number: int, item: Item, folder: Path) -> Fed:
    log, size = folder / "err.log", size_of(item)
    before, said_before = _rss_mb(), _bytes(log)
    _forget_peak()
    began = _spent()
    with within(folder) as outside:
        end, said = _ended(kind, item)
    spent, told = _spent() - began, _said(log, said_before)
    if end in ("done", "refused") and TRACE in told:
        end, said = "traceback", told.decode("utf-8", "replace").strip().splitlines()[-1][:200]
    wrote = next(iter(outside), "")
    slow = spent > slow_of(kind) * max(1.0, size / SLOW_BYTES)
    return Fed(number, end, round(spent, 3), size, round(_peak_mb() - before, 1), wrote, said, slow)


def _ended(kind: ModuleType, item: Item) -> tuple[str, str]:
    """How the product answered: done, refused, or with an error that is none of ours and where it came up."""
    try:
        kind.feed(item)
    except PluginFault as fault:  # a built-in plugin that breaks its interface
        return "traceback", str(fault)[:200]
    except SgcadError:
        return "refused", ""
    except BaseException as fault:  # noqa: BLE001 - whatever it is, it is what is looked for
        where = traceback.extract_tb(fault.__traceback__)[-1]
        return "traceback", f"{type(fault).__name__}: {str(fault)[:150]} ({Path(where.filename).name}:{where.lineno})"
    return "done", ""


# ------------------------------------------------------------------ measuring
def size_of(item: Item) -> int:
    """Bytes of an input: of a file, of all files of a folder, of bytes or a text."""
    if isinstance(item, Path):
        return sum(_bytes(file) for file in (item.rglob("*") if item.is_dir() else [item]))
    return len(item if isinstance(item, bytes) else item.encode("utf-8", "surrogatepass"))


def _bytes(file: Path) -> int:
    try:
        return file.lstat().st_size
    except OSError:
        return 0


def _spent() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _rss_mb() -> float:
    return float(psutil.Process().memory_info().rss) / 2**20


def _forget_peak() -> None:
    """Make the kernel take the memory of now for the most so far."""
    if sys.platform.startswith("linux"):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _peak_mb() -> float:
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines() if sys.platform == "linux" else []
    peak = next((line.split()[1] for line in lines if line.startswith("VmHWM:")), None)
    return float(peak) / 1024 if peak else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _said(log: Path, before: int) -> bytes:
    if _bytes(log) <= before:
        return b""
    with log.open("rb") as content:
        content.seek(before)
        return content.read(100_000)


def _remove(item: Path) -> None:
    for file in _innermost_first(item):
        try:
            file.rmdir() if file.is_dir() and not file.is_symlink() else file.unlink()
        except OSError:
            continue


def _innermost_first(item: Path) -> Iterator[Path]:
    inner = sorted(item.rglob("*"), reverse=True) if item.is_dir() and not item.is_symlink() else []
    yield from (*inner, item)


if __name__ == "__main__":
    main()
