"""How many ego files load in another player, and in how many an ego that is driven as in the report meets its crash.

    python -m research.benchmarks.handover.ego_files RUNS [--library libesminiLib.so] [--pace 1.0] [--late 0] [--most N]

The ego's file of every executed case below RUNS is written anew and driven from outside: along the way of the report's
driver, `--pace` times as fast, `--late` seconds after the start. Without a library our own player plays it, with the
ego's motion as one more maneuver. A crash is met where the ego touches the same actor first; `sides`: on the same
sides too. Prints one line of figures and the cases that failed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flows.drive.script_of_case import case_folders
from flows.export.ego_files import ROLES, write_ego_files
from flows.export.finished_case import FinishedCase
from research.benchmarks.handover import esmini_library
from research.benchmarks.handover.esmini_library import NOT_LOADED, STEP_S
from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.errors import SgcadError
from sgcad_core.execution.contact import first_with
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.player import play_scenario
from sgcad_core.formats.openscenario.reading.elements import read_root
from sgcad_core.formats.openscenario.roads.road_network import roads_of
from sgcad_core.geometry.plane import Floats
from sgcad_core.handover.ego_file.ego import ego_motion
from sgcad_core.handover.ego_file.scripts import FILE
from sgcad_core.handover.script import Staging, staging_for
from sgcad_core.system.temp_folders import temp_folder

TIMEOUT_S = 120
LONGEST_S = 60.0


@dataclass(frozen=True)
class Driving:
    """How the ego is driven, and in what."""

    library: Path | None
    pace: float = 1.0
    late_s: float = 0.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures; 1 where a file did not load."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--library", type=Path, help="esmini's library; default: our own player")
    parser.add_argument("--pace", type=float, default=1.0)
    parser.add_argument("--late", type=float, default=0.0)
    parser.add_argument("--ego", default="responder", help="a role")
    parser.add_argument("--most", type=int)
    options = parser.parse_args(arguments)
    how = Driving(options.library, options.pace, options.late)
    wanted = options.ego if options.ego in ROLES else "responder"
    counts, seconds = Counter[str](), 0.0
    for folder in case_folders([options.runs])[: options.most]:
        try:
            outcome, took = _judged(FinishedCase(folder), wanted, how)
        except SgcadError as fault:
            outcome, took = f"failed: {fault}", 0.0
        seconds += took
        first = outcome.split(":")[0]
        counts.update(["cases", *_implied(first)])
        if first not in ("sides", "no contact in the report"):
            sys.stdout.write(f"{folder.name}: {outcome}\n")
    told = "; ".join(f"{name} {number}" for name, number in counts.items())
    sys.stdout.write(f"{told}; writing {1000 * seconds / max(counts['loaded'], 1):.1f} ms of processor time a case\n")
    return int(counts["not loaded"] > 0)


def _implied(outcome: str) -> list[str]:
    """An outcome with those that it includes."""
    chain = ["loaded", "with a crash", "met", "sides"]
    if outcome == "no contact in the report":
        return ["loaded", outcome]
    if outcome == "missed":
        return [*chain[:2], outcome]
    return chain[: chain.index(outcome) + 1] if outcome in chain else [outcome]


def _judged(case: FinishedCase, wanted: str, how: Driving) -> tuple[str, float]:
    """Outcome in words, and processor time of writing the files, seconds."""
    ego = case.ego(wanted)
    staging = staging_for(case.script, ego)
    roads_of(case.xodr).nearest(Pose(0.0, 0.0, 0.0))  # in a run the map was read before, by the validators
    with temp_folder("ego") as folder:
        (folder / "road.xodr").write_text(case.xodr, encoding="utf-8")
        started = time.process_time()
        write_ego_files(folder, case.script, ego, case.source, case.behavior, case.xodr, "1.2")
        took = time.process_time() - started
        poses = _poses(staging, how)
        tracks = _own(folder, staging, poses, case.xodr) if how.library is None else _esmini(folder, ego, poses, how)
    return ("not loaded" if tracks is None else _outcome(staging, tracks)), took


def _outcome(staging: Staging, tracks: dict[str, Trajectory]) -> str:
    want = staging.contact
    others = [t for name, t in tracks.items() if name != staging.ego]
    seen = first_with(tracks[staging.ego], others, staging.script.sizes)
    if want is None:
        return "no contact in the report"
    if seen is None or {seen.actor, seen.other} != {want.actor, want.other}:
        return f"missed: {_said(seen)} instead of {_said(want)}"
    same = _areas(seen) == _areas(want)
    return "sides" if same else f"met: {_said(seen)} instead of {_said(want)}"


def _areas(contact: ObservedContact) -> dict[str, str]:
    return {contact.actor: contact.actor_area, contact.other: contact.other_area}


def _said(contact: ObservedContact | None) -> str:
    if contact is None:
        return "nothing"
    one, two = f"{contact.actor} {contact.actor_area}", f"{contact.other} {contact.other_area}"
    return f"{one} and {two} at {contact.t_s:.2f} s"


# ------------------------------------------------------------------ the ego
def _poses(staging: Staging, how: Driving) -> Floats:
    """(n, 4) x, y, heading, speed of the ego's origin every 0.05 s."""
    move = ego_motion(staging, staging.contact_s)
    t = np.arange(0.0, LONGEST_S, STEP_S) - how.late_s
    script = np.clip(t * how.pace, 0.0, float(move.t_s[-1]))
    x, y, heading, speed = (
        np.interp(script, move.t_s, told) for told in (move.x_m, move.y_m, move.heading_rad, move.speed_mps)
    )
    return np.column_stack((x, y, heading, speed * how.pace * (t >= 0)))


# ------------------------------------------------------------------ the players
def _esmini(folder: Path, ego: str, poses: Floats, how: Driving) -> dict[str, Trajectory] | None:
    np.save(folder / "poses.npy", poses)
    library = str((how.library or Path()).resolve())
    files = [str(folder / name) for name in (FILE, "poses.npy", "out.npz")]
    command = [sys.executable, esmini_library.__file__, library, files[0], ego, *files[1:]]
    done = subprocess.run(command, capture_output=True, cwd=folder, timeout=TIMEOUT_S, check=False)  # noqa: S603
    if done.returncode == NOT_LOADED:
        return None
    if done.returncode:
        last = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
        raise SgcadError(f"esmini ended with {done.returncode}: {' '.join(last)}")
    found = np.load(folder / "out.npz")
    return {str(name): _track(str(name), found[str(name)]) for name in found["names"]}


def _track(name: str, table: Floats) -> Trajectory:
    x, y, heading, speed = table.T
    t_s = np.arange(len(table)) * STEP_S
    return Trajectory(actor=name, t_s=t_s, x_m=x, y_m=y, heading_rad=np.unwrap(heading), speed_mps=speed)


def _own(folder: Path, staging: Staging, poses: Floats, xodr: str) -> dict[str, Trajectory]:
    text = (folder / FILE).read_text(encoding="utf-8")
    group = _driven(staging.ego, poses)
    text = text.replace('<ManeuverGroup name="', f'{group}\n<ManeuverGroup name="', 1)
    played = play_scenario(read_root(text), roads_of(xodr))
    return {t.actor: t for t in played.trajectories}


def _driven(ego: str, poses: Floats) -> str:
    """A maneuver group that moves the ego along its poses from the start on."""
    vertices = "".join(
        f'<Vertex time="{k * STEP_S:.2f}"><Position><WorldPosition x="{x:.6f}" y="{y:.6f}" h="{h:.8f}"/></Position>'
        "</Vertex>"
        for k, (x, y, h, _) in enumerate(poses.tolist())
    )
    return (
        f'<ManeuverGroup name="driver" maximumExecutionCount="1"><Actors selectTriggeringEntities="false">'
        f'<EntityRef entityRef="{ego}"/></Actors><Maneuver name="drive"><Event name="drives" priority="override">'
        '<Action name="driven"><PrivateAction><RoutingAction><FollowTrajectoryAction><TrajectoryRef>'
        f'<Trajectory name="driven" closed="false"><Shape><Polyline>{vertices}</Polyline></Shape></Trajectory>'
        '</TrajectoryRef><TimeReference><Timing domainAbsoluteRelative="absolute" scale="1" offset="0"/>'
        '</TimeReference><TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>'
        '</PrivateAction></Action><StartTrigger><ConditionGroup><Condition name="now" delay="0" conditionEdge="none">'
        '<ByValueCondition><SimulationTimeCondition value="0" rule="greaterOrEqual"/></ByValueCondition></Condition>'
        "</ConditionGroup></StartTrigger></Event></Maneuver></ManeuverGroup>"
    )


if __name__ == "__main__":
    sys.exit(main())
