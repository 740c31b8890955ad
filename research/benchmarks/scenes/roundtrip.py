"""Does netconvert read our OpenDRIVE files as the networks that they were made from?

    python -m research.benchmarks.scenes.roundtrip RUNS [--random 300] [--list 20]

Every road.xodr below RUNS (and, with --random, as many networks of seeded random road specs) is read by `netconvert
--opendrive-files` alone, and by sgcad's reader of existing maps, which adds what netconvert passes over: signs, two-way
left-turn lanes, all but the first of several lanes that lead into one. Both are compared with the road.net.xml. One row
an aspect: networks without a difference; then the first differences.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import get_args

from research.benchmarks.scenes.random_roads import random_networks
from research.benchmarks.scenes.reimport import ASPECTS, Difference, Reader, differences
from research.benchmarks.written_files import written_files

READERS: tuple[Reader, ...] = get_args(Reader)
Lost = Mapping[Reader, Sequence[Difference]]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where sgcad's own reading differs, 2 where there is nothing to compare."""
    options = _parser().parse_args(arguments)
    found = [
        (name, {reader: differences(net, xodr, reader) for reader in READERS})
        for name, net, xodr in chain(_runs(options.runs), _random(options.random))
    ]
    if not found:
        sys.stderr.write(f"{options.runs}: no road.xodr beside a road.net.xml in it; give a folder of runs\n")
        return 2
    sys.stdout.write(table(found, options.list))
    return int(any(lost["sgcad"] for _, lost in found))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--random", type=int, default=0, help="networks of random road specs as well")
    parser.add_argument("--list", type=int, default=20, help="differences to name")
    return parser


def _runs(folder: Path) -> Iterator[tuple[str, str, str]]:
    for xodr in written_files(folder, "road.xodr"):
        net = xodr.with_name("road.net.xml")
        if net.exists():
            yield xodr.parent.name, net.read_text(encoding="utf-8"), xodr.read_text(encoding="utf-8")


def _random(count: int) -> Iterator[tuple[str, str, str]]:
    for name, network in random_networks(count) if count else ():
        if network.net_xml and network.xodr:
            yield name, network.net_xml, network.xodr


def table(found: Sequence[tuple[str, Lost]], most: int) -> str:
    """Networks without a difference, aspect by aspect and reader by reader, then the first differences."""
    rows = [f"{'as before, of ' + str(len(found)):24}" + "".join(f"{reader:>12}" for reader in READERS)]
    for aspect in (*ASPECTS, "all"):
        counts = [_clean(found, reader, aspect) for reader in READERS]
        rows.append(f"{aspect:24}" + "".join(f"{count:>12}" for count in counts))
    named = [
        f"{reader}: {name}: {d.aspect} {d.where}: {d.before} -> {d.after}"
        for reader in READERS
        for name, lost in found
        for d in lost[reader]
    ]
    return "\n".join([*rows, *named[:most], ""])


def _clean(found: Sequence[tuple[str, Lost]], reader: Reader, aspect: str) -> str:
    if (reader, aspect) == ("netconvert", "signs"):
        return "reads none"
    return str(sum(all(aspect not in ("all", d.aspect) for d in lost[reader]) for _, lost in found))


if __name__ == "__main__":
    sys.exit(main())
