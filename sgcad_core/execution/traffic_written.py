"""Traffic put into a scenario file and played from there: what the player shows is what counts.

Players move evenly between the vertices of a file, so bodies are compared once more as they are played. Knows the
player and the contact computation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.density import Density
from sgcad_core.case.records import Trajectory, sizes_of
from sgcad_core.case.traffic import CrashScene, Traffic
from sgcad_core.errors import InvalidOutput, NoTraffic
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.traffic import Drive, traffic_around
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.geometry.plane import Size, gaps_where_near

COARSE = 4
"""Of so many rows one is written: 0.2 s, in which a vehicle that brakes at 4.5 m/s2 strays by 0.02 m."""
PLAYED_CLEAR_M = 0.3
TOUCHED = "touched something as it is played"


@dataclass(frozen=True)
class CrashWithTraffic:
    """A crash's scenario file with traffic, and the traffic as it is played. `xosc`: None where the crash has none."""

    xosc: str | None
    traffic: Traffic


def add_traffic(scene: CrashScene, xodr: str | None, density: Density, seed: int, drive: Drive) -> CrashWithTraffic:
    """Traffic of a density around a crash, in its scenario file too.

    No vehicle of it touches an actor, and the actors' first contact is what it is without it. Raises NoTraffic,
    SimulationFailed; InvalidOutput for a scenario file that takes none.
    """
    traffic = traffic_around(scene, density, seed, drive)
    if scene.xosc is None:
        return CrashWithTraffic(None, traffic)
    return _written(scene, scene.xosc, xodr, traffic)


def _written(scene: CrashScene, xosc: str, xodr: str | None, traffic: Traffic) -> CrashWithTraffic:
    # the library that writes takes half a second to import
    from sgcad_core.formats.openscenario.writing.background import with_background, without_background

    xosc = without_background(xosc)
    while traffic.vehicles:
        text = with_background(xosc, traffic.vehicles, [_coarse(track) for track in traffic.trajectories])
        played = {track.actor: track for track in play(text, xodr)}
        seen = tuple(played[track.actor] for track in traffic.trajectories)
        touching = set(_touching(scene, seen, sizes_of(traffic.vehicles)))
        if not touching:
            _check(scene, played)
            return CrashWithTraffic(text, traffic.model_copy(update={"trajectories": seen}))
        traffic = _without(traffic, touching)
    raise NoTraffic(f"{scene.case}: no vehicle keeps clear of the crash as the scenario is played: traffic none")


def _coarse(track: Trajectory) -> Trajectory:
    rows = np.unique(np.append(np.arange(0, len(track.t_s), COARSE), len(track.t_s) - 1))
    return track.model_copy(
        update={name: getattr(track, name)[rows] for name in ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")}
    )


def _touching(scene: CrashScene, seen: Sequence[Trajectory], sizes: Mapping[str, Size]) -> Iterator[str]:
    """Ids of vehicles that come too near to an actor, or touch a vehicle before them."""
    actors = sizes_of(scene.actors)
    for number, track in enumerate(seen):
        near = (_least(track, sizes[track.actor], t, actors[t.actor], PLAYED_CLEAR_M) for t in scene.trajectories)
        touch = (_least(track, sizes[track.actor], t, sizes[t.actor], 0.0) for t in seen[:number])
        if any(gap <= PLAYED_CLEAR_M for gap in near) or any(gap <= 0 for gap in touch):
            yield track.actor


def _least(a: Trajectory, a_size: Size, b: Trajectory, b_size: Size, near_m: float) -> float:
    n = min(len(a.t_s), len(b.t_s))
    return float(gaps_where_near(a.pose[:n], a_size, b.pose[:n], b_size, near_m).min())


def _check(scene: CrashScene, played: Mapping[str, Trajectory]) -> None:
    """Raises InvalidOutput where the actors' first contact is another one with the traffic in the file."""
    sizes = sizes_of(scene.actors)
    told = first_contact(scene.trajectories, sizes)
    now = first_contact([played[actor.id] for actor in scene.actors], sizes)
    if told != now:
        raise InvalidOutput(f"{scene.case}: with traffic the first contact would be {now}, without it is {told}")


def _without(traffic: Traffic, names: set[str]) -> Traffic:
    left_out = {**traffic.removed, TOUCHED: traffic.removed.get(TOUCHED, 0) + len(names)}
    return traffic.model_copy(update={
        "vehicles": tuple(v for v in traffic.vehicles if v.id not in names), "removed": left_out,
        "trajectories": tuple(t for t in traffic.trajectories if t.actor not in names),
        "entrants": tuple(e for e in traffic.entrants if e.id not in names),
    })  # fmt: skip
