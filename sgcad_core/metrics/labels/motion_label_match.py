"""Motion against a label: number of vehicles, headings, maneuvers, and the first contact with its areas.

Only vehicles of the report (V1, V2, ...) count. Knows paths and labels, no network and no file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.geometry.plane import Box, Size, box_gaps, contact_area, wrap_angle

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
TURNS = {"turn_left": 1.0, "turn_right": -1.0, "u_turn": 1.0}
STILL = ("stopped", "parked")
STILL_M, STRAIGHT_DEG, TURNED_DEG = 2.0, 30.0, 12.0
"""A smaller displacement is standing, a smaller turn is straight; a turn that a contact cuts short has begun at 12
degrees."""
STOOD_S = 1.0
"""Time for which a vehicle that stopped stands before its first contact at least."""
_VEHICLE = re.compile(r"V\d+$")


class Path(NamedTuple):
    """One actor's motion: (n,) seconds, (n, 3) x, y, heading of the box's center, and its length and width, metres."""

    t_s: Floats
    pose: Floats
    size: Size


class Touch(NamedTuple):
    """The first contact of an execution: time, and touched area by actor."""

    t_s: float
    areas: Mapping[str, str]


def motion_marks(label: Mapping[str, Any], paths: Mapping[str, Path]) -> dict[str, float]:
    """field -> share right, for what the label states of these: number of vehicles, first headings and those
    relative to V1, maneuvers, whether a crash comes about, between which actors, on which sides."""
    moving = {actor: path for actor, path in paths.items() if _VEHICLE.match(actor)}
    vehicles = [v for v in label.get("vehicles", ()) if _VEHICLE.match(str(v.get("id", "")))]
    touch = first_touch(moving)
    found: dict[str, float | None] = {}
    if vehicles:
        found["vehicle_count"] = float(len(moving) == len(vehicles))
    found["initial_heading"] = _share(_heading_right(v, moving) for v in vehicles)
    found["maneuver"] = _share(_maneuver_right(v, moving, touch) for v in vehicles)
    turn = label["network"].get("relative_heading_v2_minus_v1")
    if turn is not None:
        found["relative_heading"] = float({"V1", "V2"} <= set(moving) and _relative_turn(moving) == turn)
    found |= _contact_marks(label, touch)
    return {name: value for name, value in found.items() if value is not None}


def first_touch(paths: Mapping[str, Path]) -> Touch | None:
    """The earliest instant at which two boxes overlap; of pairs in the same instant the first by id."""
    found: tuple[float, str, str, Box, Box] | None = None
    for a, b in combinations(sorted(paths), 2):
        _, i, j = np.intersect1d(paths[a].t_s.round(3), paths[b].t_s.round(3), return_indices=True)
        first, second = paths[a].pose[i], paths[b].pose[j]
        hits = np.flatnonzero(box_gaps(first, paths[a].size, second, paths[b].size) <= 0)
        if not hits.size:
            continue
        k = int(hits[0])
        if found is None or paths[a].t_s[i[k]] < found[0]:
            one, two = Box.at(first[k], paths[a].size), Box.at(second[k], paths[b].size)
            found = float(paths[a].t_s[i[k]]), a, b, one, two
    if found is None:
        return None
    t, a, b, one, two = found
    return Touch(t, {a: contact_area(one, two), b: contact_area(two, one)})


# ------------------------------------------------------------------ single fields
def _share(marks: Iterable[float | None]) -> float | None:
    known = [m for m in marks if m is not None]
    return sum(known) / len(known) if known else None


def _heading_right(vehicle: Mapping[str, Any], paths: Mapping[str, Path]) -> float | None:
    """Within an eighth of the label's compass word."""
    want = vehicle.get("initial_heading") or vehicle.get("heading_from_text")
    if want not in COMPASS:
        return None
    path = paths.get(vehicle["id"])
    if path is None:
        return 0.0
    made = round((90 - math.degrees(path.pose[0, 2])) % 360 / 45) % 8
    apart = abs(made - COMPASS.index(want))
    return float(min(apart, 8 - apart) <= 1)


def _maneuver_right(vehicle: Mapping[str, Any], paths: Mapping[str, Path], touch: Touch | None) -> float | None:
    """Turning, standing and going straight, by the path before the first contact; other kinds are not judged."""
    kind = vehicle.get("manoeuvre_resolved") or vehicle.get("manoeuvre")
    if maneuver_shown(kind, 0.0, 0.0) is None:
        return None
    path = paths.get(vehicle["id"])
    if path is None:
        return 0.0
    pose = path.pose[path.t_s <= touch.t_s] if touch else path.pose
    moved = way_m(kind, pose, path.t_s[: len(pose)])
    turned = math.degrees(float(wrap_angle(np.diff(pose[:, 2])).sum()))
    return float(bool(maneuver_shown(kind, moved, turned)))


def way_m(kind: str | None, pose: Floats, t_s: Floats) -> float:
    """The displacement over (n, 3) poses that tells a maneuver: of one that stopped, that while it stood."""
    first = int(np.searchsorted(t_s, t_s[-1] - STOOD_S)) if kind == "stopped" else 0
    return float(np.hypot(*(pose[-1, :2] - pose[first, :2])))


def maneuver_shown(kind: str | None, moved_m: float, turned_deg: float) -> bool | None:
    """Whether a displacement and a turn (counterclockwise) show a maneuver; None: they cannot decide."""
    if kind in STILL:
        return moved_m < STILL_M
    if kind in TURNS:
        return turned_deg * TURNS[kind] > TURNED_DEG
    return moved_m >= STILL_M and abs(turned_deg) < STRAIGHT_DEG if kind == "straight" else None


def _relative_turn(paths: Mapping[str, Path]) -> int:
    """Clockwise turn from V1's first heading to V2's, to the nearest quarter, degrees."""
    apart = math.degrees(paths["V1"].pose[0, 2] - paths["V2"].pose[0, 2])
    return round(apart % 360 / 90) % 4 * 90


def _contact_marks(label: Mapping[str, Any], touch: Touch | None) -> dict[str, float | None]:
    """Whether anything touched, whether it was the label's pair, and on the label's sides."""
    events = (e for e in label.get("events", ()) if e.get("kind") == "collision")
    hit = next((e for e in events if str(e.get("other", "")).startswith("V")), None)
    if hit is None:
        return {}
    want = {hit[who].split(" ")[0]: _sides(hit, who) for who in ("actor", "other")}
    seen = touch.areas if touch else {}
    pair = set(seen) == set(want)
    right = float(pair and all(seen[v] in want[v] for v in want)) if all(want.values()) else None
    return {"collision_any": float(touch is not None), "collision_pair": float(pair), "collision_areas": right}


def _sides(hit: Mapping[str, Any], who: str) -> tuple[str, ...]:
    """The side of a label and, for a corner, the other one that is right too; empty without one."""
    told = _side(hit.get(f"{who}_area"))
    return tuple(filter(None, (told, _side(hit.get(f"{who}_area_also"))))) if told else ()


def _side(text: str | None) -> str:
    """ "rear (left corner)" -> "back"; empty where the label names no side."""
    word = (text or "").split(" ")[0].split("_")[0]
    return {"rear": "back"}.get(word, word)
