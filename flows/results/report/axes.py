"""One square of a figure of cases: bare axes, text, the road, a road user."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from flows.player.overview_png import draw_network
from flows.results.report.scene import Scene
from sgcad_core.geometry.plane import Box, corners

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIDE_IN = 2.3
SOFT = "#66707a"


def bare(axes: Axes) -> None:
    """No ticks, a thin frame."""
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_color("#d5d9d5")


def say(axes: Axes, text: str, color: str = SOFT) -> None:
    """Words instead of a picture."""
    wrapped = "\n".join(piece for line in text.splitlines() for piece in textwrap.wrap(line, 26) or [""])
    at = axes.transAxes
    axes.text(0.5, 0.5, wrapped, transform=at, ha="center", va="center", size=8, color=color, parse_math=False)


def under(axes: Axes, text: str, color: str = SOFT) -> None:
    """A line under a picture."""
    axes.set_xlabel(text, fontsize=7.5, color=color, parse_math=False)


def look(axes: Axes, scene: Scene, middle: tuple[float, float], half_m: float, side_in: float = SIDE_IN) -> None:
    """The road around a place."""
    axes.set(xlim=(middle[0] - half_m, middle[0] + half_m), ylim=(middle[1] - half_m, middle[1] + half_m))
    axes.set_aspect("equal")
    draw_network(axes, scene.drawing, side_in * 0.9 * 72 / (2 * half_m))


def car(axes: Axes, box: Box, color: str) -> None:
    """A road user."""
    from matplotlib.patches import Polygon

    axes.add_patch(Polygon(corners(box), closed=True, facecolor=color, edgecolor="white", linewidth=0.7, zorder=5))


def star(axes: Axes, at: tuple[float, float], color: str) -> None:
    """Draw the mark of a contact."""
    axes.plot(*at, marker=(10, 1, 0), markersize=10, color=color, markeredgecolor="white", zorder=6)
