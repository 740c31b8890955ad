"""The case gallery's data: every case with its report, a small diagram, and each arm's network, paths and verdicts.

Small plain values: decimeters as whole numbers around the first contact, a point every half second.
"""

from __future__ import annotations

import base64
import io
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from PIL import UnidentifiedImageError

from flows.case.case_in_words import lacking_in_words
from flows.player.player_data import COLORS
from flows.player.player_page import told_in
from flows.player.sentence_marks import MARK_WORDS
from flows.results.reading import FinishedCase, paths_of
from flows.results.table import Tables, reference_of
from sgcad_core.case.records import Floats
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.xml import Element, parse_xml
from sgcad_core.result import as_declared, counts_of
from sgcad_core.system.pictures import opened

THUMB_PX = 240
EVERY_S = 0.5
NEAR_M = 90.0
"""Road farther from the middle than this is not sent; the picture shows 45 m to each side at most."""
NARRATIVE_CHARS = 6_000
LACKING_SHOWN = 6
"""Number of things that lack named in a tile; the player names all."""
VERDICTS = (
    ("intersections_wrong", "intersections", 0.0), ("lanes_wrong", "lanes", 0.0), ("connectivity_wrong", "parts", 0.0),
    ("lanes_total", "lanes total", 1.0), ("legs", "legs", 1.0), ("vehicle_count", "vehicles", 1.0),
    ("initial_heading", "headings", 1.0), ("maneuver", "maneuvers", 1.0), ("collision_pair", "contact pair", 1.0),
    ("collision_areas", "sides", 1.0),
)  # fmt: skip
"""Key of a value, its label in the gallery, and the right value."""


def gallery(tables: Tables, page: Path) -> dict[str, Any]:
    """The data for the page's script. `page`: path of the page; links to players are relative to it."""
    study = tables.study
    return {
        "arms": [{"name": a.name, "label": a.label} for a in study.arms],
        "marked": MARK_WORDS,
        "verdicts": [label for _, label, _ in VERDICTS],
        "cases": [_case(tables, case, page) for case in study.cases if any(case in r for r in study.ran.values())],
    }


def _case(tables: Tables, case: str, page: Path) -> dict[str, Any]:
    runs = [tables.study.ran[a.name].get(case) for a in tables.study.arms]
    first = reference_of(tables.study)  # arms may have read a degraded report: the reference's comes first
    told = sorted((ran for ran in runs if ran), key=lambda ran: ran.arm != first)
    diagram = next((f for ran in told if (f := ran.folder / "diagram.png").is_file()), None)
    text = _read(told[0].folder / "report.txt")
    return {
        "id": case,
        "text": text[:NARRATIVE_CHARS],
        "told": _told(told[0], min(len(text), NARRATIVE_CHARS)),
        "img": _thumb(diagram) if diagram else None,
        "arms": [_arm(ran, tables.values[ran.arm][case], page) if ran else None for ran in runs],
    }


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return ""


def _told(ran: FinishedCase, chars: int) -> list[list[Any]]:
    """[start, end, mark] of each sentence of the text as shown that ends within so many characters."""
    told = told_in(_read(ran.folder / "player.html"), ran.result)
    return [[one.start, one.end, one.mark] for one in told if one.end <= chars]


def _thumb(diagram: Path) -> str | None:
    """The diagram as a small data URL; None where it is no picture."""
    out = io.BytesIO()
    try:
        with opened(diagram) as image:
            image.thumbnail((THUMB_PX, THUMB_PX))
            image.convert("RGB").save(out, format="WEBP", quality=55)
    except (OSError, UnidentifiedImageError):
        return None
    return "data:image/webp;base64," + base64.b64encode(out.getvalue()).decode("ascii")


def _arm(ran: FinishedCase, values: Mapping[str, float], page: Path) -> dict[str, Any]:
    """One tile: status, verdicts (1 right, 0 wrong, null unstated), figures to sort by, and what to draw."""
    player = ran.folder / "player.html"
    collision = ran.result.get("collision") or {}
    return {
        "status": ran.result["status"],
        "why": str(ran.result.get("reason") or "")[:300],
        "declared": as_declared(ran.result),
        "observed": collision.get("observed"),
        "account": _account(ran.result),
        "right": [int(values[key] == want) if key in values else None for key, _, want in VERDICTS],
        "level": (ran.metrics.get("exact") or {}).get("emergency_level"),
        "speed": values.get("x_speed"),
        "attempts": values.get("attempts"),
        "error": sum(values.get(f"{k}_error", 0.0) for k in ("intersections", "lanes", "connectivity")),
        "player": quote(os.path.relpath(player, page.parent)) if player.is_file() else None,
        "draw": _drawn(ran),
    }


def _account(result: Mapping[str, Any]) -> dict[str, Any] | None:
    """Counts, and the first things told that lack."""
    account = counts_of(result)
    if account is None:
        return None
    lacks = [line for line in (lacking_in_words(account, LACKING_SHOWN),) if line]
    kept = {key: account[key] for key in ("verdict", "told", "has", "lacking", "assumed")}
    return kept | {"lacks": lacks, "sentence": verdict_sentence(result)}


# ------------------------------------------------------------------ what to draw
def _drawn(ran: FinishedCase) -> dict[str, Any] | None:
    """Roads, paths and the contact in decimetres around the middle; None where there is no network."""
    try:
        root = parse_xml((ran.folder / "road.net.xml").read_text(encoding="utf-8"), "net_xml")
        paths = paths_of(ran.folder, ran.result)
    except (OSError, ValueError, InvalidOutput):
        return None
    contact = (ran.result.get("collision") or {}).get("observed") or {}
    t_s = float(contact.get("t_s") or 0.0)
    poses = {a: p.pose[int(np.abs(p.t_s - t_s).argmin())] for a, p in paths.items()}
    involved = [poses[a][:2] for a in (contact.get("actor"), contact.get("other")) if a in poses]
    middle = np.mean(involved or [p[:2] for p in poses.values()] or [(0.0, 0.0)], axis=0)
    return {
        "lanes": [[width, points] for width, shape in _lanes(root) if (points := _near(shape, middle))],
        "areas": [points for shape in _areas(root) if (points := _near(shape, middle))],
        "movers": [
            {
                "id": actor,
                "color": COLORS[k % len(COLORS)],
                "way": _around(path.pose[:: max(1, round(EVERY_S / 0.05)), :2], middle),
                "at": [*_around(poses[actor][None, :2], middle), round(float(poses[actor][2]), 2)],
                "size": [round(v * 10) for v in path.size],
            }
            for k, (actor, path) in enumerate(paths.items())
        ],
    }


def _lanes(root: Element) -> Iterator[tuple[int, Floats]]:
    """Width in decimetres and center line of each lane of a road."""
    for edge in root.iterfind("edge"):
        if edge.get("function", "normal") == "normal":
            for lane in edge.iterfind("lane"):
                yield round(10 * float(lane.get("width", 3.2))), _points(lane)


def _areas(root: Element) -> Iterator[Floats]:
    for junction in root.iterfind("junction"):
        if junction.get("type") not in ("internal", "dead_end") and junction.get("shape"):
            yield _points(junction)


def _points(element: Element) -> Floats:
    return np.array([[float(v) for v in p.split(",")[:2]] for p in element.get("shape", "").split()]).reshape(-1, 2)


def _near(points: Floats, middle: Floats) -> list[int]:
    """The shape, or nothing if it is farther off than NEAR_M."""
    low, high = points.min(axis=0), points.max(axis=0)
    if len(points) < 2 or (np.maximum(low - middle, middle - high) > NEAR_M).any():
        return []
    return _around(points, middle)


def _around(points: Floats, middle: Floats) -> list[int]:
    flat: list[int] = np.rint((points - middle) * 10).astype(int).ravel().tolist()
    return flat
