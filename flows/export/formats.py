"""The formats of `sgcad export`: one function each, which writes a case's files and names them."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from flows.export.ego_files import write_ego_files
from flows.export.finished_case import FinishedCase
from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, Version
from sgcad_core.handover.ego_file.cue import cue_of
from sgcad_core.handover.ego_file.others import AFTER_S, motion_of
from sgcad_core.handover.script import Staging, staging_for


@dataclass(frozen=True)
class Wish:
    """What a person chose."""

    ego: str = "responder"
    """A role or an actor's id."""
    version: Version = DEFAULT_VERSION


def _ego(case: FinishedCase, place: Path, wish: Wish) -> list[Path]:
    """`ego.xosc` with its map and scripts, in a folder of the ego's name."""
    ego = case.ego(wish.ego)
    folder = place / ego
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "road.xodr").write_text(case.xodr, encoding="utf-8")
    return write_ego_files(
        folder, case.script, ego, case.source, case.behavior, case.xodr, wish.version, case.background
    )


def _commonroad(case: FinishedCase, place: Path, wish: Wish) -> list[Path]:
    """A planning problem for the ego; the others go on as if it were not there."""
    from sgcad_core.formats.commonroad.write import Problem, write_commonroad

    ego, (staging, contact_s) = case.ego(wish.ego), _staged(case, wish)
    others = [motion_of(staging, name, contact_s, AFTER_S) for name in staging.lines if name not in staging.coupled]
    others += [track for _, track in case.background]
    infos = _infos(case)
    place.mkdir(parents=True, exist_ok=True)
    file = place / f"{case.script.case}.xml"
    mine = motion_of(staging, ego, contact_s, AFTER_S)
    problem = Problem(case.script.case, case.script.graph, infos, mine, others, case.source.date[:10])
    file.write_text(write_commonroad(problem), encoding="utf-8")
    return [file]


def _infos(case: FinishedCase) -> dict[str, ActorInfo]:
    """Actors and background vehicles by id."""
    return {info.id: info for info in (*case.script.actors, *(vehicle for vehicle, _ in case.background))}


def _staged(case: FinishedCase, wish: Wish) -> tuple[Staging, float]:
    """The ego's staging, and when the conflict is."""
    staging = staging_for(case.script, case.ego(wish.ego))
    return staging, cue_of(staging, 0.0).contact_s


def _dsl(case: FinishedCase, place: Path, wish: Wish) -> list[Path]:
    """The text of the scenario up to the contact, beside its map."""
    from sgcad_core.formats.dsl.write import Told, write_dsl

    script, observed = case.script, (case.result.get("collision") or {}).get("observed")
    contact = ObservedContact.model_validate(observed) if observed else None
    rows = round(contact.t_s / STEP_S) + 1 if contact else len(script.trajectories[0].t_s)
    moves = [_first_rows(track, rows) for track in script.trajectories]
    infos = {actor.id: actor for actor in script.actors}
    notes = [case.source.about, *(f"assumed: {line}" for line in case.source.assumed)]
    if case.background:
        notes.append(f"left out: {len(case.background)} vehicles of the traffic around the crash")
    told = Told(script.case, infos, moves, contact, _acts(case), [note for note in notes if note])
    place.mkdir(parents=True, exist_ok=True)
    (place / "road.xodr").write_text(case.xodr, encoding="utf-8")
    file = place / f"{script.case}.osc"
    file.write_text(write_dsl(told), encoding="utf-8")
    return [file]


def _first_rows(track: Trajectory, rows: int) -> Trajectory:
    names = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")
    return track.model_copy(update={name: getattr(track, name)[:rows] for name in names} | {"roll_rad": None})


def _acts(case: FinishedCase) -> dict[str, list[str]]:
    """By actor, the acts of the report's timeline in words."""
    found: dict[str, list[str]] = {}
    for act in case.result.get("timeline", ()):
        parts = [act["kind"].replace("_", " "), act.get("other") or "", act.get("value") or "", act.get("lane") or ""]
        found.setdefault(act["actor"], []).append(" ".join(part for part in map(str, parts) if part))
    return found


def _scenarionet(case: FinishedCase, place: Path, wish: Wish) -> list[Path]:
    """The record, and the two tables by which ScenarioNet finds it."""
    from sgcad_core.formats.scenarionet.record import DATASET, scenario_record

    script, ego = case.script, case.ego(wish.ego)
    tracks = (*script.trajectories, *(track for _, track in case.background))
    record = scenario_record(script.case, script.graph, _infos(case), tracks, ego)
    place.mkdir(parents=True, exist_ok=True)
    file = place / f"sd_{DATASET}_v1_{script.case}.pkl"
    tables = {file: record, place / "dataset_summary.pkl": {file.name: record["metadata"]}}
    tables[place / "dataset_mapping.pkl"] = {file.name: ""}
    for target, content in tables.items():
        target.write_bytes(pickle.dumps(content))
    return list(tables)


FORMATS: Mapping[str, Callable[[FinishedCase, Path, Wish], list[Path]]] = {
    "ego": _ego, "commonroad": _commonroad, "dsl": _dsl, "scenarionet": _scenarionet,
}  # fmt: skip
