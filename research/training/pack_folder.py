"""A training folder as a few small flat files, for machines that hand back little: pack there, unpack here.

`python -m research.training.pack_folder RUN FOLDER` writes at most 8 files of at most 14 MiB; `python -m
research.training.pack_folder --unpack FOLDER RUN` puts them back, and training goes on from there.
"""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Sequence
from pathlib import Path

PART = 14 << 20
STATE, LOG, TOKENIZER = "state.pt", "log.jsonl", "tokenizer"


def pack(run: Path, folder: Path) -> list[Path]:
    """The files written: state in parts, log, tokenizer."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob(f"{STATE}.*"):
        old.unlink()
    state = (run / STATE).read_bytes()
    for index, start in enumerate(range(0, len(state), PART)):
        (folder / f"{STATE}.{index}").write_bytes(state[start : start + PART])
    shutil.copy(run / LOG, folder / LOG)
    for file in sorted((run / TOKENIZER).iterdir()):
        shutil.copy(file, folder / f"{TOKENIZER}-{file.name}")
    return sorted(folder.iterdir())


def unpack(folder: Path, run: Path) -> None:
    """Restore a training folder. Raises FileNotFoundError where parts are missing."""
    parts = sorted(folder.glob(f"{STATE}.*"), key=lambda p: int(p.suffix[1:]))
    if not parts or [int(p.suffix[1:]) for p in parts] != list(range(len(parts))):
        raise FileNotFoundError(f"{folder}: found parts {[p.name for p in parts]} of {STATE}; copy all of them there")
    (run / TOKENIZER).mkdir(parents=True, exist_ok=True)
    (run / STATE).write_bytes(b"".join(p.read_bytes() for p in parts))
    shutil.copy(folder / LOG, run / LOG)
    for file in folder.glob(f"{TOKENIZER}-*"):
        shutil.copy(file, run / TOKENIZER / file.name.removeprefix(f"{TOKENIZER}-"))


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.training.pack_folder", description=__doc__)
    parser.add_argument("--unpack", action="store_true")
    parser.add_argument("source", type=Path)
    parser.add_argument("target", type=Path)
    options = parser.parse_args(arguments)
    (unpack if options.unpack else pack)(options.source, options.target)


if __name__ == "__main__":
    main()
