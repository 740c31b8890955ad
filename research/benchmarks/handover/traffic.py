"""How many cases take traffic, and whether it leaves their crashes as they are.

    python -m research.benchmarks.handover.traffic RUNS [--density light] [--seed 42] [--esmini BINARY] [--most N]

Traffic is put around the crash of every executed case below RUNS, and the file is played from scratch by our player
and, with a binary, by esmini. A touch is an overlap of a background vehicle with an actor of the crash, before the
first contact or after it; `same crash`: the actors' first contact is between the same sides as without traffic. Prints
a line of figures for each player, and the cases without traffic or with a touch.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from flows.drive.script_of_case import case_folders
from flows.export.export_traffic import SIMULATOR
from flows.export.finished_case import FinishedCase
from flows.export.traffic_files import traffic_around_script
from sgcad_core.case.density import DENSITIES
from sgcad_core.case.records import RoadNetwork, Scenario, Trajectory, sizes_of
from sgcad_core.case.traffic import Traffic
from sgcad_core.errors import NoTraffic, SgcadError
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.traffic_written import CrashWithTraffic
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.geometry.plane import Size, first_overlap
from sgcad_core.handover.script import Script
from sgcad_core.interfaces import Simulator
from sgcad_core.registry import plugin_class


@dataclass
class Figures:
    """Counts over cases, by player where a file was played."""

    cases: int = 0
    seconds: list[float] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    touches: Counter[str] = field(default_factory=Counter)
    same: Counter[str] = field(default_factory=Counter)
    said: list[str] = field(default_factory=list)

    def lines(self) -> Iterator[str]:
        """The figures in words."""
        took = sorted(self.seconds)
        done = len(took)
        told = ", ".join(f"{n} {what}" for what, n in self.counts.items())
        yield f"{self.cases} cases, {done} with traffic: {told}"
        if done:
            yield f"seconds a case: median {took[done // 2]:.2f}, most {took[-1]:.2f}"
        for player in self.same:
            touched = self.touches[player]
            yield f"{player}: same crash {self.same[player]} of {done}; vehicles that touch an actor: {touched}"
        yield from self.said


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures; 1 where a crash is another one or is touched."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--density", choices=DENSITIES, default="light")
    parser.add_argument("--seed", type=int, default=42)
    parser.add_argument("--esmini", default="", help="esmini's binary; default: our player alone")
    parser.add_argument("--most", type=int)
    options = parser.parse_args(arguments)
    try:
        figures = measure(options)
    except SgcadError as fault:
        sys.stderr.write(f"{fault}\n")
        return 2
    sys.stdout.write("\n".join(figures.lines()) + "\n")
    return int(bool(figures.touches) or any(n != len(figures.seconds) for n in figures.same.values()))


def measure(options: argparse.Namespace) -> Figures:
    """The figures of all cases. Raises BadInput, MissingTool."""
    figures, simulator = Figures(), cast("Simulator", plugin_class("simulator", SIMULATOR)())
    esmini = cast("Simulator", plugin_class("simulator", "esmini")(path=options.esmini)) if options.esmini else None
    if esmini:
        esmini.ready()
    for folder in case_folders([options.runs])[: options.most]:
        case, started = FinishedCase(folder), time.perf_counter()
        figures.cases += 1
        try:
            made = traffic_around_script(case.script, case.xodr, options.density, options.seed, simulator)
        except NoTraffic as fault:
            figures.said.append(f"without: {fault}")
            continue
        figures.seconds.append(time.perf_counter() - started)
        _count(figures, made.traffic)
        for player, tracks in _played(case, made, esmini):
            _compare(figures, player, case.script, made.traffic, tracks)
    return figures


def _count(figures: Figures, traffic: Traffic) -> None:
    figures.counts.update({"wanted": traffic.wanted, "placed": len(traffic.vehicles), "began elsewhere": traffic.moved})
    figures.counts.update(traffic.removed)


def _played(
    case: FinishedCase, made: CrashWithTraffic, esmini: Simulator | None
) -> Iterator[tuple[str, tuple[Trajectory, ...]]]:
    if made.xosc is None:
        return
    yield "our player", play(made.xosc, case.xodr)
    if esmini:
        scenario = Scenario(xosc=made.xosc, actors=(*case.script.actors, *made.traffic.vehicles))
        yield "esmini", esmini.execute(scenario, RoadNetwork(xodr=case.xodr)).trajectories


def _compare(figures: Figures, player: str, script: Script, traffic: Traffic, tracks: Iterable[Trajectory]) -> None:
    by_id = {track.actor: track for track in tracks}
    crash = [by_id[actor.id] for actor in script.actors]
    sizes = sizes_of((*script.actors, *traffic.vehicles))
    told, seen = first_contact(script.trajectories, sizes), first_contact(crash, sizes)
    parts = [(c.actor, c.other, c.actor_area, c.other_area) if c else None for c in (told, seen)]
    figures.same[player] += parts[0] == parts[1]
    if parts[0] != parts[1]:
        figures.said.append(f"{script.case}: {player} sees {seen}, without traffic {told}")
    for vehicle in traffic.vehicles:
        for actor in crash:
            if _touch(by_id[vehicle.id], actor, sizes):
                figures.touches[player] += 1
                figures.said.append(f"{script.case}: {player}: {vehicle.id} touches {actor.actor}")


def _touch(a: Trajectory, b: Trajectory, sizes: dict[str, Size]) -> bool:
    n = min(len(a.t_s), len(b.t_s))
    return first_overlap(a.pose[:n], sizes[a.actor], b.pose[:n], sizes[b.actor]) is not None


if __name__ == "__main__":
    raise SystemExit(main())
