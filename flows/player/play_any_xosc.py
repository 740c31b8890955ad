"""`sgcad play`: any scenario file played, as a table of motion, a page, contacts and metrics.

Deviations from the file are noted in played.json and in the page; an unsupported element is an error that names the
element and its line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations, islice
from pathlib import Path
from typing import Any

import numpy as np

from flows.case_files import case_folder
from flows.case_files.find_cases import safe_id
from flows.player import player_page
from flows.player.player_data import COLORS, Mover, View
from flows.player.road_shapes import Drawing, Strip
from sgcad_core.case.records import ActorInfo, CrashReport, Execution, Finding, ObservedContact, Scenario, sizes_of
from sgcad_core.errors import ConfigError
from sgcad_core.execution.contact import first_contact
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.player import Played
from sgcad_core.formats.openscenario.reading.files import Variation, play_file, variations
from sgcad_core.formats.openscenario.roads.road_network import roads_of
from sgcad_core.kinds import ACTORS, kind_of_letter
from sgcad_core.metrics.measure import ego_of, measure
from sgcad_core.result import CaseRecord

BESIDE_M = 60.0
"""Margin of the drawn map around the paths of the entities."""
MAX_PAIR_INSTANTS = 150_000
"""Pairs of entities times instants whose metrics are computed; a pair takes up to 0.1 ms an instant."""


def play(file: Path, out: Path, given: Sequence[str], maps: Sequence[Path], most: int, until_s: float) -> list[Path]:
    """Play a scenario file, or the parameter sets of a distribution file; the folders that were written.

    `given`: NAME=VALUE for parameters. Raises ConfigError, BadInput, InvalidOutput, Unsupported.
    """
    asked = variations(file, _parameters(given))
    own = out / safe_id(file.stem)  # `...xosc` would else lead out of it
    written = []
    for variation in islice(asked, most):
        folder = own / variation.name if variation.name else own
        _one(variation, folder, maps, until_s, len(asked))
        written.append(folder)
    return written


def _parameters(given: Sequence[str]) -> dict[str, str]:
    if wrong := next((entry for entry in given if "=" not in entry), None):
        raise ConfigError(f"--set {wrong}: write NAME=VALUE")
    return dict(entry.split("=", 1) for entry in given)


def _one(variation: Variation, folder: Path, maps: Sequence[Path], until_s: float, of: int) -> None:
    played, xodr = play_file(variation, maps, until_s=until_s)
    actors = [_info(name, played.bodies[name]) for name in (t.actor for t in played.trajectories)]
    sizes = sizes_of(actors)
    execution = Execution(
        simulator="player", trajectories=played.trajectories, contact=first_contact(played.trajectories, sizes)
    )
    played, metrics = _measured(played, execution, Scenario(actors=tuple(actors)))
    folder.mkdir(parents=True, exist_ok=True)
    case_folder.write_trajectories(folder / "trajectories.csv", played.trajectories)
    case_folder.write_json(folder / "contacts.json", [c.model_dump() for c in _contacts(played, sizes)])
    case_folder.write_json(folder / "metrics.json", metrics)
    case_folder.write_json(folder / "played.json", _played_row(variation, played, of))
    view = _view(variation, played, execution, metrics, actors, xodr)
    (folder / "player.html").write_text(player_page.page(view), encoding="utf-8")


def _measured(played: Played, execution: Execution, scenario: Scenario) -> tuple[Played, dict[str, Any]]:
    """The metrics of all entities; of very many those that come nearest to the first one, with a note."""
    tracks, count = execution.trajectories, len(execution.trajectories[0].t_s)
    most = max(2, int((1 + math.sqrt(1 + 8 * MAX_PAIR_INSTANTS / count)) / 2))
    if len(tracks) <= most:
        return played, measure(execution, scenario)
    ego = ego_of(track.actor for track in tracks)
    me = next(track for track in tracks if track.actor == ego)
    apart = {t.actor: float(np.hypot(t.x_m - me.x_m, t.y_m - me.y_m).min()) if t is not me else -1.0 for t in tracks}
    kept = sorted(apart, key=apart.__getitem__)[:most]
    near = execution.model_copy(update={"trajectories": tuple(t for t in tracks if t.actor in kept)})
    what = f"the metrics are those of the {most} of {len(tracks)} entities that come nearest to {ego}"
    note = Finding(source="player", severity="note", what=what, remedy="play it for a shorter time (--until)")
    return replace(played, notes=(*played.notes, note)), measure(near, scenario)


def _contacts(played: Played, sizes: Mapping[str, tuple[float, float]]) -> list[ObservedContact]:
    """First contact of every pair while both are present, in order of time; without hitched trailers."""
    found = []
    for a, b in combinations(played.trajectories, 2):
        first, second = played.bodies[a.actor], played.bodies[b.actor]
        contact = None if first.tow is second or second.tow is first else first_contact((a, b), sizes)
        if contact and all(_there(played, name, contact.t_s) for name in (a.actor, b.actor)):
            found.append(contact)
    return sorted(found, key=lambda contact: contact.t_s)


def _there(played: Played, name: str, t_s: float) -> bool:
    begin, end = played.presence[name]
    return begin - 1e-9 <= t_s <= end + 1e-9


def _info(name: str, body: Body) -> ActorInfo:
    return ActorInfo(id=name, type=_kind(body), length_m=body.box.length_m, width_m=body.box.width_m, maneuver="other")


def _kind(body: Body) -> str:
    """The kind that is nearest to an entity: of its category, else the usual one of its sort."""
    if body.kind != "Vehicle":
        return kind_of_letter("P" if body.kind == "Pedestrian" else "O")
    known = (r.id for r in ACTORS.values() if r.axles and body.category in (r.category, *r.also))
    return next(known, kind_of_letter("V"))


def _played_row(variation: Variation, played: Played, of: int) -> dict[str, Any]:
    return {
        "file": variation.file.name,
        "set": variation.name,
        "sets": of,
        "parameters": variation.given,
        "seconds": round(float(played.trajectories[0].t_s[-1]), 6),
        "entities": [
            {"name": t.actor, "from_s": played.presence[t.actor][0], "to_s": played.presence[t.actor][1]}
            for t in played.trajectories
        ],
        "notes": [{k: v for k, v in note.model_dump().items() if v} for note in played.notes],
    }


# ------------------------------------------------------------------ page
def _view(
    variation: Variation,
    played: Played,
    execution: Execution,
    metrics: Mapping[str, Any],
    actors: Sequence[ActorInfo],
    xodr: str | None,
) -> View:
    pairs = enumerate(zip(actors, played.trajectories, strict=True))
    movers = [Mover(actor, track, COLORS[k % len(COLORS)]) for k, (actor, track) in pairs]
    seen = execution.contact.model_dump() if execution.contact else None
    result = {
        "status": "played",
        "collision": {"declared": None, "realised": False, "observed": seen},
        "network": None,
        "grounding": {},
        "attempts": {"road": 0, "scenario": 0},
        "seconds": {},
    }
    notes = "\n".join(note.line() for note in played.notes)
    report = CrashReport(case=variation.file.stem, narrative=notes or "Played as the file says, without notes.")
    record = CaseRecord(case=variation.file.stem, config=variation.name or "player", execution=execution)
    return View(record, report, metrics, result, _drawing(xodr, played), tuple(movers))


def _drawing(xodr: str | None, played: Played) -> Drawing:
    """The lanes near the entities."""
    if xodr is None:
        return Drawing(areas=(), strips=(), lines=())
    x, y = (np.concatenate([getattr(t, axis) for t in played.trajectories]) for axis in ("x_m", "y_m"))
    low, high = np.array([x.min(), y.min()]) - BESIDE_M, np.array([x.max(), y.max()]) + BESIDE_M
    strips = [
        Strip(points, width_m, cars)
        for points, width_m, cars in roads_of(xodr).strips()
        if ((points >= low) & (points <= high)).all(axis=1).any()
    ]
    return Drawing(areas=(), strips=tuple(strips), lines=())
