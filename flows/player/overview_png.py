"""picture.png: the network with all paths over time, for MLflow and for papers."""

from __future__ import annotations

import io
import threading
from typing import TYPE_CHECKING

import numpy as np

from flows.player.player_data import TRAFFIC_COLOR, Mover, View, label_color
from flows.player.road_shapes import Drawing
from sgcad_core.geometry.plane import Box, corners
from sgcad_core.roads.areas.closures import CONE_M

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sgcad_core.case.records import Trajectory

SIZE_IN = 6.4
DPI = 110
MARGIN_M, LEAST_M, MOST_M = 14.0, 25.0, 75.0
"""Of half the side: around the paths, at least, and at most where there is a contact to stand in the middle."""
GHOST_S = 1.0
"""Time between two drawn boxes of an actor; earlier ones are paler."""
CONE = "#ff7a1a"
BESIDE = {"curb": ("#8f918b", ""), "ditch": ("#cfc6ae", "xx"), "embankment": ("#dde3cf", "\\\\\\")}
"""Color and hatch of ground beside roads."""
BESIDE_LINE = "#a3a890"
GROUND, ASPHALT, WHITE, YELLOW, RED = "#eef0ea", "#5b6067", "#f4f4f0", "#e8b93c", "#d7263d"
LINES = {
    "edge": (WHITE, 0.9, "-"),
    "lane": (WHITE, 0.8, (0, (5, 6))),
    "center": (YELLOW, 1.1, "-"),
    "stop": (WHITE, 2.4, "-"),
}
"""Color, width in points and dashes of each painted line."""
_pen = threading.Lock()  # matplotlib's font cache is not made for threads


def png(view: View) -> bytes:
    """The picture as PNG, about 700 px square."""
    with _pen:
        return _draw(view)


def _draw(view: View) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE_IN, SIZE_IN), dpi=DPI, facecolor=GROUND)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    middle, half = frame(view)
    axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    points_per_m = SIZE_IN * 72 / (2 * half)
    draw_network(axes, view.drawing, points_per_m)
    _traffic(axes, view)
    for mover in view.movers:
        draw_path(axes, mover)
    _contact(axes, view)
    _legend(axes, view)
    out = io.BytesIO()
    figure.savefig(out, format="png", pil_kwargs={"compress_level": 2})
    return out.getvalue()


def frame(view: View) -> tuple[tuple[float, float], float]:
    """Middle and half the side of the square that holds every path, or 150 m around a contact, metres."""
    if not view.movers:
        return (0.0, 0.0), 60.0
    points = np.vstack([m.track.points for m in view.movers])
    low, high = points.min(axis=0), points.max(axis=0)
    half, contact = max(float((high - low).max()) / 2 + MARGIN_M, LEAST_M), view.contact_point()
    if contact is not None and half > MOST_M:
        return contact, MOST_M
    middle = (low + high) / 2
    return (float(middle[0]), float(middle[1])), half


def draw_network(axes: Axes, drawing: Drawing, points_per_m: float) -> None:
    """Asphalt and painted lines, in metres; a lane's width is drawn in points."""
    from matplotlib.collections import LineCollection, PolyCollection

    areas = list(drawing.areas)
    axes.add_collection(PolyCollection(areas, facecolors=ASPHALT, edgecolors=ASPHALT, linewidths=0.5, zorder=1))
    widths = [s.width_m * points_per_m for s in drawing.strips]
    colors = [ASPHALT if s.cars else "#a9a69c" for s in drawing.strips]
    strips = [s.points for s in drawing.strips]
    axes.add_collection(LineCollection(strips, linewidths=widths, colors=colors, capstyle="butt", zorder=1))
    axes.add_collection(
        PolyCollection(drawing.gores, facecolors=ASPHALT, edgecolors=WHITE, hatch="///", linewidths=0.8, zorder=1.5)
    )
    for kind, (color, hatch) in BESIDE.items():
        areas = [corners for told, corners in drawing.grounds if told == kind]
        ground = PolyCollection(
            areas, facecolors=color, edgecolors=BESIDE_LINE, hatch=hatch, linewidths=0.4, zorder=0.8
        )
        axes.add_collection(ground)
    if len(drawing.cones):
        size = max(CONE_M * points_per_m, 2.0)
        axes.plot(*drawing.cones.T, linestyle="none", marker="o", markersize=size, color=CONE, zorder=2.5)
    for style, (color, width, dashes) in LINES.items():
        lines = [line.points for line in drawing.lines if line.style == style]
        axes.add_collection(LineCollection(lines, colors=color, linewidths=width, linestyles=[dashes], zorder=2))


def draw_path(axes: Axes, mover: Mover) -> None:
    """Draw an actor's path and its box every second, the later the stronger."""
    from matplotlib.collections import PolyCollection

    track, color = mover.track, mover.color
    axes.plot(track.x_m, track.y_m, color=color, linewidth=1.6, alpha=0.9, solid_capstyle="round", zorder=3)
    every = max(1, round(GHOST_S / 0.05))
    steps = list(range(0, len(track.t_s), every))
    size = mover.info.length_m, mover.info.width_m
    boxes = [corners(Box(float(track.x_m[k]), float(track.y_m[k]), float(track.heading_rad[k]), *size)) for k in steps]
    alphas = np.linspace(0.25, 0.95, len(boxes))
    axes.add_collection(
        PolyCollection(boxes, facecolors=color, edgecolors="white", linewidths=0.5, alpha=alphas, zorder=4)
    )
    first = _first_shown(axes, track)
    label = axes.annotate(mover.info.id, first, xytext=(7, 7), textcoords="offset points", annotation_clip=False)
    label.set(color="white", fontsize=8, fontweight="bold", zorder=6)
    label.set_bbox(
        {"boxstyle": "round,pad=0.25", "facecolor": label_color(color), "edgecolor": "white", "linewidth": 0.8}
    )


def _first_shown(axes: Axes, track: Trajectory) -> tuple[float, float]:
    """Where a path begins, or comes into the picture, with room for a name."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    room = 0.06 * (right - left)
    across = (track.x_m > left + room) & (track.x_m < right - room)
    k = int(np.argmax(across & (track.y_m > bottom + room) & (track.y_m < top - room)))
    return float(track.x_m[k]), float(track.y_m[k])


def _traffic(axes: Axes, view: View) -> None:
    """Background vehicles where they are at the contact, else halfway."""
    from matplotlib.collections import PolyCollection

    contact = view.record.execution.contact if view.record.execution else None
    boxes = []
    for info, track in view.traffic:
        at = contact.t_s if contact else float(track.t_s[-1]) / 2
        k = min(int(np.searchsorted(track.t_s, at)), len(track.t_s) - 1)
        x, y, heading = (float(v) for v in track.pose[k])
        boxes.append(corners(Box(x, y, heading, info.length_m, info.width_m)))
    axes.add_collection(PolyCollection(boxes, facecolors=TRAFFIC_COLOR, edgecolors="white", linewidths=0.4, zorder=2.8))


def _contact(axes: Axes, view: View) -> None:
    if (point := view.contact_point()) is not None:
        axes.plot(
            *point, linestyle="none", zorder=5, marker=(10, 1, 0), markersize=14, color=RED, markeredgecolor="white"
        )


def _legend(axes: Axes, view: View) -> None:
    """Draw the case's name, the contact and its time, and a scale bar."""
    observed = view.result["collision"]["observed"]
    text = view.record.case
    if observed:
        text += f"\n{observed['actor']} {observed['actor_area']} meets {observed['other']} {observed['other_area']}"
        text += f" at {observed['t_s']:.2f} s"
    near = (view.result.get("near_crash") or {}).get("observed")
    if near and not observed:
        text += f"\nnear crash: {near['actor']} and {near['other']} closest {near['clearance_m']:.1f} m"
        text += f" at {near['t_s']:.1f} s"
    text += f"\ngray: traffic {'at that time' if observed else 'halfway'}" if view.traffic else ""
    box = {"boxstyle": "round,pad=0.4", "facecolor": "white", "alpha": 0.85, "edgecolor": "none"}
    axes.text(0.02, 0.98, text, transform=axes.transAxes, va="top", fontsize=8.5, bbox=box, parse_math=False, zorder=7)
    half = (axes.get_xlim()[1] - axes.get_xlim()[0]) / 2
    length = next(m for m in (100, 50, 20, 10, 5) if m < half * 0.8)
    left = 0.97 - length / (2 * half)
    axes.fill_between([left - 0.01, 0.98], 0.02, 0.075, transform=axes.transAxes, color="white", alpha=0.85, zorder=6)
    axes.plot([left, 0.97], [0.035, 0.035], transform=axes.transAxes, color="#333", linewidth=2.5, zorder=7)
    said = f"{length} m · north up"
    axes.text(0.97, 0.045, said, transform=axes.transAxes, ha="right", fontsize=8, color="#333", zorder=7)
