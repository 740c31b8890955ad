"""Broken and hostile input by the thousand: `python -m research.benchmarks.fuzz [--count 10000] [--seed 1] [--only text
...]`.

Reports of words that reports have, in orders that none has, and files of ours with bytes, numbers and pieces changed.
Every input ends as a result or as one of our own errors, within a time that grows with its length, and nothing is
written but where the input lies. Ends with 1 otherwise and prints the seed of each input that did not: an input is a
function of kind and seed, `sample(KINDS["text"], 17)`.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from research.benchmarks.fuzz.kinds import KINDS
from research.benchmarks.fuzz.making import example
from research.benchmarks.fuzz.trying import heed, tried

WHOLE = 20
"""Of so many inputs one goes the whole way to its folder, which takes half a second."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a kind and one a fault; 1 if there is any."""
    parser = argparse.ArgumentParser(prog="python -m research.benchmarks.fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10_000, help="inputs of every kind")
    parser.add_argument("--seed", type=int, default=1, help="of the first input; they follow each other")
    parser.add_argument("--only", nargs="+", choices=list(KINDS))
    asked = parser.parse_args(arguments)
    logging.disable(logging.ERROR)  # pypdf tells of every damaged file
    sys.addaudithook(heed)
    example()
    with tempfile.TemporaryDirectory(prefix="sgcad-fuzz-") as place:
        tempfile.tempdir = place
        return int(sum(_kind(name, asked, Path(place)) for name in asked.only or KINDS) > 0)


def _kind(name: str, asked: argparse.Namespace, place: Path) -> int:
    """Try every input of a kind and say how they ended; how many did not end well."""
    began, count = time.process_time(), asked.count // (WHOLE if name == "case" else 1)
    slowest, faults = 0.0, []
    for seed in range(asked.seed, asked.seed + count):
        outcome = tried(KINDS[name], seed, place)
        slowest = max(slowest, outcome.seconds)
        faults += [outcome] if outcome.wrong else []
    each = 1000 * (time.process_time() - began) / max(1, count)
    sys.stdout.write(f"{name}: {count - len(faults)} of {count} well, {each:.1f} ms each, slowest {slowest:.2f} s\n")
    for fault in faults[:20]:
        sys.stdout.write(f"  seed {fault.seed}: {fault.wrong}\n")
    sys.stdout.flush()
    return len(faults)


if __name__ == "__main__":
    sys.exit(main())
