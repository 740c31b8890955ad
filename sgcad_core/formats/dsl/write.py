"""A crash as OpenSCENARIO DSL 2.1: who takes part, which way each goes, and what they do side by side.

Each actor has a path and a series of movements along it, each with its speed at both ends (`drive`, or `walk` of a
person); the series run in parallel up to the contact. What the report tells stands beside them as comments. Behind the
contact nothing is told. Places are box centers in the map's axes. Knows no file and no parser.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory
from sgcad_core.formats.openscenario.writing.pacing import pieces
from sgcad_core.formats.openscenario.writing.vertices import path_rows
from sgcad_core.geometry.plane import arc_lengths

STANDS_M = 0.2
"""An actor that goes less than this stands."""
_WORDS = frozenset(
    "action actor and any as bool call cover def default do elapsed else emit enum event every expression extend "  # noqa: SIM905
    "external fall false float global hard if import in inherits int is it keep list modifier not of on one_of only or "
    "parallel range record remove_default rise sample scenario serial string struct true type uint undefined unit "
    "until var wait with".split()
)
"""Words of the language, which name nothing."""
_CATEGORIES = {name: name for name in ("car", "van", "truck", "bus", "bicycle")} | {"motorbike": "motorcycle"}


@dataclass(frozen=True)
class Told:
    """What the text says of a crash."""

    case: str
    infos: Mapping[str, ActorInfo]
    moves: Sequence[Trajectory]
    """Up to the contact, or to the end of a crash without one; all on one clock."""
    contact: ObservedContact | None = None
    acts: Mapping[str, Sequence[str]] | None = None
    """By actor, what the report tells of it, in its order."""
    notes: Sequence[str] = ()
    """What else is to be said, such as what is assumed."""
    road_file: str = "road.xodr"


def write_dsl(told: Told) -> str:
    """The text of a scenario."""
    lines = [f"# {line}" for line in (f"{told.case}: from a crash report, by SG-CADVLM.", *map(_line, told.notes))]
    lines += ["import osc.standard.all", "", f"scenario {name_of(told.case)}:"]
    lines += [f"    {line}".rstrip() for line in (*_map(told), *_actors(told), *_paths(told), *_story(told))]
    return "\n".join(lines) + "\n"


def name_of(text: str) -> str:
    """A name that the language takes."""
    plain = re.sub(r"\W+", "_", text.lower(), flags=re.ASCII).strip("_")
    return plain if re.match(r"[a-z]", plain) and plain not in _WORDS else f"n_{plain}"


def _line(text: str) -> str:
    return " ".join(text.split())


def _map(told: Told) -> Iterator[str]:
    yield "world: map with:"
    yield f'    keep(it.map_file == "{told.road_file}")'
    yield ""


def _actors(told: Told) -> Iterator[str]:
    for move in told.moves:
        info = told.infos[move.actor]
        yield f"{name_of(info.id)}: {_actor(info)} with:"
        if category := _CATEGORIES.get(info.record.category) if info.record.axles else None:
            yield f"    keep(it.vehicle_category == {category})"
        for side, metres in (("length", info.length_m), ("width", info.width_m)):
            yield f"    keep(it.bounding_box.{side} == {metres:.2f}m)"
        yield ""


def _actor(info: ActorInfo) -> str:
    if info.record.axles is not None:
        return "vehicle"
    return "stationary_object" if info.record.thing else "person"


def _paths(told: Told) -> Iterator[str]:
    for move in told.moves:
        if _stands(move):
            continue
        name = name_of(move.actor)
        places = ", ".join(_place(move, row) for row in path_rows(move, 0.0))
        yield f"{name}_points: list of position_3d = [{places}]"
        yield f"{name}_path: path = world.create_path_xyz_points(points: {name}_points, interpolation: straight_line)"
    yield ""


def _place(move: Trajectory, row: int) -> str:
    x, y = (float(v) + 0.0 for v in move.points[row])
    return f"position_3d(x: {x:.2f}m, y: {y:.2f}m, z: 0.0m)"


def _stands(move: Trajectory) -> bool:
    return bool(arc_lengths(move.points)[-1] < STANDS_M)


# ------------------------------------------------------------------ the story
def _story(told: Told) -> Iterator[str]:
    if (seen := told.contact) is not None:
        yield f"# {seen.actor} {seen.actor_area} meets {seen.other} {seen.other_area} at {seen.t_s:.2f} s."
    yield "do parallel:"
    for move in told.moves:
        for act in (told.acts or {}).get(move.actor, ()):
            yield f"    # told: {_line(act)}"
        yield f"    {name_of(move.actor)}_story: serial:"
        yield from (f"        {line}" for line in _movements(told.infos[move.actor], move))


def _movements(info: ActorInfo, move: Trajectory) -> Iterator[str]:
    name, span = name_of(info.id), float(move.t_s[-1] - move.t_s[0])
    heading = float(move.heading_rad[0])
    yield f"{name}.assign_position({_place(move, 0)})"
    yield f"{name}.assign_orientation(orientation_3d(roll: 0.0rad, pitch: 0.0rad, yaw: {heading:.4f}rad))"
    if _stands(move):
        yield f"{name}_stands: wait elapsed({span:.2f}s)"
        return
    does = "walk" if _actor(info) == "person" else "drive" if _actor(info) == "vehicle" else "move"
    times, speeds = pieces(move.t_s, arc_lengths(move.points))
    for k, ((begin, first), (end, last)) in enumerate(pairwise(zip(times, np.maximum(speeds, 0.0), strict=True)), 1):
        yield f"{name}_{k}: {name}.{does}(duration: {end - begin:.2f}s) with:"
        yield f"    follow_path(absolute: {name}_path)"
        if abs(last - first) < 0.02:
            yield f"    speed({first:.2f}mps)"
        else:
            yield f"    speed({first:.2f}mps, at: start)"
            yield f"    speed({last:.2f}mps, at: end)"
