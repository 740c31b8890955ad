"""How long a narrative takes to read as it grows: linear for real prose, and for text made to stall the reader.

    python -m research.benchmarks.texts.reading_time [--largest 100000]

Each kind of text is read at a quarter, a half and the whole of the largest size; the last column is the seconds of the
whole over those of the half, 2 where time grows with length. Knows nothing of what is read.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence

from sgcad_core.reading.reading import read

PROSE = (
    "V1, a 2001 Ford Focus, was traveling northbound on a two-lane, two-way road, approaching an intersection. "
    "V2, a 1999 Honda Civic, was traveling eastbound on the intersecting two-lane roadway. "
    "The front of V1 struck the left side of V2. It was daylight and the road was dry. "
)
KINDS: dict[str, str] = {
    "prose": PROSE,
    "abbreviations": "at St. Main Ave. No. Hwy. Rd. ",
    "one abbreviation": "U.S. A.M. Dr. ",
    "spaces": " ",
    "spaces before lines": "      x",
    "empty lines": " \n",
    "full stops": ". ",
    "brackets": "(V1 (",
    "vehicles without numbers": "a Ford struck a Honda and another Toyota. ",
    "strangers": "unknown a sedan ",
    "lanes": "two northbound lanes and three eastbound lanes and a left turn lane ",
    "roads": "the two-lane road met the three-lane street. ",
    "one-way roads": "V1 was on the one-way road. V2 was on another two-way road. ",
    "numbers": "V1 V2 V3 ",
    "areas": "the left front right rear side door ",
    "blows": "V1 struck V2 with its left front. ",
    "compass": "north south east west ",
    "letters": "x",
    "no spaces": "struck,",
}
"""What a text of each kind repeats."""


def text_of(kind: str, size: int) -> str:
    """A text of about `size` characters, the first sentence plain."""
    piece = KINDS[kind]
    return (PROSE + piece * (size // len(piece)))[:size]


def seconds(text: str) -> float:
    """Processor seconds of one reading: another program on the machine does not count."""
    began = time.process_time()
    read(text)
    return time.process_time() - began


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a kind of text."""
    parser = argparse.ArgumentParser(prog="python -m research.benchmarks.texts.reading_time")
    parser.add_argument("--largest", type=int, default=100_000, help="characters")
    parser.add_argument("--kind", choices=list(KINDS), default=None)
    args = parser.parse_args(arguments)
    seconds(PROSE)  # patterns compile
    for kind in [args.kind] if args.kind else list(KINDS):
        took = [seconds(text_of(kind, args.largest // part)) for part in (4, 2, 1)]
        row = "  ".join(f"{s:7.2f} s" for s in took)
        sys.stdout.write(f"{kind:26s} {row}  x{took[2] / max(took[1], 1e-6):.1f}\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
