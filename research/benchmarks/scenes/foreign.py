"""Which OpenSCENARIO files of a folder our player plays, what it refuses by name, and how far it lies from esmini.

    python -m research.benchmarks.scenes.foreign FOLDER [--maps FOLDER] [--judge PATH_TO_ESMINI] [--blind]

A distribution file counts as played when its scenario plays with the first, the last and up to three sets between.
With a judge both players run with one step of 0.01 s and without controllers; files that switch one on are counted
apart, since they mean more than is compared. `--blind` prints totals only, of the third of the files whose names' hash
says so; without it the other two thirds are printed, file by file. Public files were read while the player was built:
figures of the open part are no test of it.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from research.benchmarks.scenes.foreign_judge import LIMIT_M, Apart, apart, judged
from sgcad_core.errors import BadInput, SgcadError, Unsupported
from sgcad_core.formats.openscenario.playing.player import Played
from sgcad_core.formats.openscenario.reading.catalogs import read_text
from sgcad_core.formats.openscenario.reading.files import Variation, play_file, variations

SETS = 5
STEP_S = 0.01
UNTIL_S = 60.0
CONTROLLERS = "controllers are the simulator's own"


@dataclass
class Tried:
    """One file: whether it plays, why not, notes, and the worst of its sets against the judge."""

    file: Path
    refused: str = ""
    element: str = ""
    notes: Counter[str] = field(default_factory=Counter)
    apart: Apart | None = None
    judge: str = ""
    """Why there is nothing to compare with."""

    @property
    def controlled(self) -> bool:
        """Whether a controller would drive something."""
        return any(note.startswith(CONTROLLERS) for note in self.notes)


def scenario_files(folder: Path) -> list[Path]:
    """Scenario and distribution files of a folder and below, without catalogs. Raises BadInput."""
    if not folder.is_dir():
        raise BadInput(f"{folder}: no such folder")
    return [f for f in sorted(folder.rglob("*.xosc")) if "<Catalog " not in read_text(f)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="+")
    parser.add_argument("--maps", type=Path, action="append", default=[])
    parser.add_argument("--judge", type=Path)
    parser.add_argument("--blind", action="store_true")
    parser.add_argument("--all", action="store_true", help="every file, open and blind part alike, totals only")
    given = parser.parse_args(arguments)
    files = [f for folder in given.folder for f in ([folder] if folder.is_file() else scenario_files(folder))]
    chosen = files if given.all else [f for f in files if blind(f) == given.blind]
    tried = [_try(file, given.maps, given.judge) for file in _shown(chosen, not (given.blind or given.all))]
    sys.stdout.write(_totals(tried, given.judge is not None))


def blind(file: Path) -> bool:
    """Whether a file belongs to the blind third, by the hash of its name."""
    return hashlib.sha256(file.name.encode()).digest()[0] % 3 == 0


def _shown(files: Sequence[Path], names: bool) -> Iterable[Path]:
    for i, file in enumerate(files):
        sys.stderr.write(f"{i + 1}/{len(files)} {file.name if names else ''}\n")
        yield file


def chosen_sets(count: int) -> list[int]:
    """First, last and up to three sets between."""
    if count <= SETS:
        return list(range(count))
    return sorted({round(i * (count - 1) / (SETS - 1)) for i in range(SETS)})


def _try(file: Path, maps: Sequence[Path], esmini: Path | None) -> Tried:
    tried = Tried(file)
    try:
        sets, text = variations(file), read_text(file)
        for i in chosen_sets(len(sets)):
            played, _ = play_file(sets[i], maps, STEP_S if esmini else 0.05, UNTIL_S)
            tried.notes.update(note.what for note in played.notes)
            if esmini and "<Stochastic" not in text:
                _compare(tried, played, sets[i], (file, i) if sets[i].name else None, (esmini, maps))
    except SgcadError as fault:
        tried.refused = str(fault)
        tried.element = _element(fault)
    return tried


def _element(fault: SgcadError) -> str:
    if isinstance(fault, Unsupported):
        return fault.element
    where = getattr(fault, "findings", ()) and fault.findings[0].where
    return where.split(" ")[0].strip("<>") if where else type(fault).__name__


def _compare(
    tried: Tried,
    played: Played,
    variation: Variation,
    of: tuple[Path, int] | None,
    judge: tuple[Path, Sequence[Path]],
) -> None:
    """`judge`: its binary, and folders of maps."""
    theirs = judged(judge[0], variation, of, STEP_S, UNTIL_S, judge[1])
    found = apart(played, theirs.motion, STEP_S) if theirs.motion else None
    if found is None:
        tried.judge = theirs.why_not or "no entity in common"
    elif tried.apart is None or found.worst_m > tried.apart.worst_m:
        tried.apart = found


def _totals(tried: Sequence[Tried], with_judge: bool) -> str:
    lines = [_line(t) for t in tried] if not any(a in sys.argv for a in ("--blind", "--all")) else []
    plays = [t for t in tried if not t.refused]
    lines.append(f"plays: {len(plays)} of {len(tried)}, {sum(1 for t in plays if t.notes)} of them with notes")
    refused = Counter(t.element for t in tried if t.refused)
    lines += [f"refused: {count} x <{element}>" for element, count in refused.most_common()]
    if with_judge:
        for controlled in (False, True):
            both = [t for t in plays if t.apart and t.controlled == controlled]
            near = sum(t.apart.worst_m <= LIMIT_M for t in both if t.apart)
            told = "with" if controlled else "without"
            lines.append(f"within {LIMIT_M:g} m of the judge, {told} controllers: {near} of {len(both)} that both play")
        lines.append(f"the judge does not play: {sum(1 for t in plays if not t.apart)}")
    return "\n".join(lines) + "\n"


def _line(tried: Tried) -> str:
    name = f"{tried.file.parent.name}/{tried.file.name}"
    if tried.refused:
        return f"{name}: refused <{tried.element}>: {tried.refused[:160]}"
    told = f"{name}: plays" + (f", notes: {'; '.join(tried.notes)[:120]}" if tried.notes else "")
    if tried.apart:
        worst, actor, first_s, common_s = tried.apart
        since = "" if first_s is None else f" from {first_s:.2f} s"
        told += f" | {worst:.2f} m ({actor}{since}, {common_s:.1f} s)"
    return told + (f" | judge: {tried.judge}" if tried.judge else "")


if __name__ == "__main__":
    main()
