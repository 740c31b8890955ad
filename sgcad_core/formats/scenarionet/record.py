"""A crash as a record of ScenarioNet: tracks, map features, metadata, all of numpy and plain values.

The fields are those of MetaDrive's ScenarioDescription: positions are box centers in metres, headings counter-clockwise
from east, 20 states a second. The ego is the track `sdc_id`. Signals are left out. Knows no file and no library of
the format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.formats.lane_pieces import Piece, pieces_of
from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import ActorRecord
from sgcad_core.roads.lane_graph import LaneGraph

VERSION, DATASET = "MetaDrive v0.4.3", "sgcad"
STEP_S = 0.05
_LANE, _ACROSS, _WALK = "LANE_SURFACE_STREET", "LANE_SURFACE_UNSTRUCTURE", "BOUNDARY_SIDEWALK"
_EDGE, _BROKEN, _YELLOW = "ROAD_EDGE_BOUNDARY", "ROAD_LINE_BROKEN_SINGLE_WHITE", "ROAD_LINE_SOLID_SINGLE_YELLOW"


def scenario_record(
    case: str, graph: LaneGraph, infos: Mapping[str, ActorInfo], tracks: Sequence[Trajectory], ego: str
) -> dict[str, Any]:
    """The record of a scenario. `tracks`: motions on one clock, the ego's among them, at least one."""
    length = max(len(track.t_s) for track in tracks)
    made = {track.actor: _track(infos[track.actor], track, length) for track in tracks}
    return {
        "id": case,
        "version": VERSION,
        "length": length,
        "tracks": made,
        "dynamic_map_states": {},
        "map_features": _features(graph),
        "metadata": {
            "id": case, "scenario_id": case, "dataset": DATASET, "sdc_id": ego, "coordinate": "right-handed",
            "metadrive_processed": False, "sample_rate": STEP_S, "timestep": np.arange(length) * STEP_S,
            "ts": np.arange(length) * STEP_S, "source_file": case, "track_length": length,
            "tracks_to_predict": {}, "objects_of_interest": [t.actor for t in tracks if t.actor != ego],
        },
    }  # fmt: skip


def _track(info: ActorInfo, track: Trajectory, length: int) -> dict[str, Any]:
    """One actor; behind its last state it is not valid."""
    n, kind = len(track.t_s), _kind(info.record)
    xyz = np.column_stack((track.points, np.full(n, info.record.height_m / 2)))
    speeds = np.gradient(track.points, STEP_S, axis=0) if n > 1 else np.zeros((n, 2))
    state = {
        "position": _padded(xyz, length),
        "velocity": _padded(speeds, length),
        "heading": _padded(track.heading_rad, length),
        "length": _padded(np.full(n, info.length_m), length),
        "width": _padded(np.full(n, info.width_m), length),
        "height": _padded(np.full(n, info.record.height_m), length),
        "valid": np.arange(length) < n,
    }
    about = {"track_length": length, "type": kind, "object_id": info.id, "dataset": DATASET, "sgcad_kind": info.type}
    return {"type": kind, "state": state, "metadata": about}


def _padded(values: Floats, length: int) -> np.ndarray[Any, np.dtype[np.float32]]:
    more = [(0, length - len(values)), *[(0, 0)] * (values.ndim - 1)]
    return np.pad(values, more).astype(np.float32)


def _kind(record: ActorRecord) -> str:
    if record.category == "bicycle":
        return "CYCLIST"
    if record.axles is not None:
        return "VEHICLE"
    return "TRAFFIC_BARRIER" if record.thing else "PEDESTRIAN"


# ------------------------------------------------------------------ map
def _features(graph: LaneGraph) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for piece in pieces_of(graph).values():
        if not piece.cars and not piece.crosses:
            found[piece.id] = {"type": _WALK, "polyline": _flat(piece.line), "polygon": _flat(piece.polygon)}
            continue
        found[piece.id] = _lane(piece)
        if not piece.crosses:
            found |= {f"{piece.id}_left": _line(piece, 1), f"{piece.id}_right": _line(piece, -1)}
    return found


def _lane(piece: Piece) -> dict[str, Any]:
    return {
        "type": _ACROSS if piece.crosses else _LANE,
        "polyline": _flat(piece.line),
        "polygon": _flat(piece.polygon),
        "speed_limit_kmh": round(piece.speed_mps * 3.6, 1),
        "entry_lanes": list(piece.before),
        "exit_lanes": list(piece.after),
        "left_neighbor": [piece.left] if piece.left else [],
        "right_neighbor": [piece.right] if piece.right else [],
        "width": np.full((len(piece.line), 2), piece.width_m / 2, dtype=np.float32),
    }


def _line(piece: Piece, side: int) -> dict[str, Any]:
    """The line at one side of a lane: broken between lanes of one direction, yellow in the middle, else the edge."""
    inner = piece.left if side > 0 else piece.right
    kind = _BROKEN if inner else _YELLOW if side > 0 else _EDGE
    return {"type": kind, "polyline": _flat(piece.side(side))}


def _flat(points: Floats) -> np.ndarray[Any, np.dtype[np.float32]]:
    """(n, 3): on flat ground."""
    return np.column_stack((points, np.zeros(len(points)))).astype(np.float32)
