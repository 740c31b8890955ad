"""Script and drive side by side: one crash at a few moments, one row per driver.

Both clocks begin at the hand-over, so both frames of a pair show the same second.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from flows.case_files.case_folder import read_json
from flows.player.overview_png import GROUND, RED
from flows.results.reading import FinishedCase, paths_of
from flows.results.report.axes import SIDE_IN, bare, car, look, say, star, under
from flows.results.report.drive_cards import StudyDrive, by_difference, drives_of
from flows.results.report.plots import Plot, as_png, canvas
from flows.results.report.scene import Scene, scene_of
from flows.results.table import Tables
from sgcad_core.metrics.labels.motion_label_match import Path as Motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_ROWS = 6
MOMENTS_S = (-1.5, 0.0, 1.0)
"""Seconds from the contact that the ego has in the script."""
NEAR_M = 24.0
COLORS = {"avoided": "#1b7f4d", "mitigated": "#7a4d00", "unchanged": "#66707a"}
BAD = "#c4203a"


def drive_frames(tables: Tables) -> list[Plot]:
    """One figure per role of the study's drives; none without drives."""
    drives = [d for d in drives_of(tables.study) if (d.folder / "trajectories.csv").is_file() and d.ego]
    return [
        _frames(tables, role, [d for d in drives if d.role == role]) for role in dict.fromkeys(d.role for d in drives)
    ]


def _frames(tables: Tables, role: str, drives: Sequence[StudyDrive]) -> Plot:
    case = by_difference(drives)[0]
    rows = [d for d in drives if d.case == case][:MOST_ROWS]
    wide = 2 * len(MOMENTS_S)
    figure = canvas(SIDE_IN * 0.86 * wide + 2.2, SIDE_IN * len(rows) + 0.4)
    grid = figure.subplots(len(rows), wide + 1, squeeze=False, width_ratios=(2.0, *[SIDE_IN] * wide))
    for axes, drive in zip(grid, rows, strict=True):
        ran, told = tables.study.ran[drive.arm][case], read_json(drive.folder / "drive.json")
        _words(axes[0], tables.study.arm(drive.arm).label, drive, told)
        _pairs(axes[1:], ran, drive, told)
    for k, axes in enumerate(grid[0][1:]):
        axes.set_title("drive" if k % 2 else "script", fontsize=8.5, fontweight="bold")
    caption = (
        f"{case}: the {role}, handed over to one driver after the other; seconds count from the contact that the "
        "script has. Of all cases the one on which the drivers differ most; the others are behind the table's letters."
    )
    return Plot(f"drives_{role}", f"Script and drive side by side: the {role}", caption, as_png(figure))


def _words(axes: Axes, label: str, drive: StudyDrive, told: Mapping[str, Any]) -> None:
    axes.set_axis_off()
    axes.text(0, 0.96, textwrap.fill(label, 20), va="top", size=8.5, weight="bold", parse_math=False)
    color = COLORS.get(drive.outcome, BAD)
    axes.text(0, 0.68, drive.outcome, va="top", size=9, color=color, weight="bold")
    lines = [f"drives {drive.ego}"]
    if told.get("braked_s") is not None:
        lines.append(f"brakes {told['braked_s']:.1f} s before")
    if told.get("hardest_mps2"):
        lines.append(f"at most {told['hardest_mps2']:.1f} m/s²")
    if drive.outcome == "avoided" and told.get("closest_m") is not None:
        lines.append(f"{told['closest_m']:.1f} m clear")
    axes.text(0, 0.54, "\n".join(lines), va="top", size=7.5, linespacing=1.4, parse_math=False)


def _pairs(grid: Sequence[Axes], ran: FinishedCase, drive: StudyDrive, told: Mapping[str, Any]) -> None:
    scene = scene_of(ran)
    for axes in grid:
        bare(axes)
        axes.set_facecolor(GROUND)
    if scene is None or scene.contact_s is None:
        return say(grid[0], "nothing touched", BAD)
    driven = paths_of(drive.folder, ran.result)
    hit = told.get("contact") or {}
    meets = float(told.get("script_contact_s") or scene.contact_s)
    for k, moment in enumerate(MOMENTS_S):
        first, second = grid[2 * k], grid[2 * k + 1]
        _frame(first, scene, scene.paths, meets + moment)
        _frame(second, scene, driven, meets + moment)
        if moment >= 0:
            star(first, scene.contact_at, RED)
        if hit and float(hit["t_s"]) <= meets + moment + 1e-6:
            under(second, f"touched after {float(hit['t_s']):.1f} s", RED)
        under(first, f"{moment:+.1f} s".replace("-", "−") if moment else "contact in the script")
    return None


def _frame(axes: Axes, scene: Scene, paths: Mapping[str, Motion], t_s: float) -> None:
    look(axes, scene, scene.contact_at, NEAR_M)
    for name, own in scene.paths.items():
        if name in paths:
            car(axes, scene.box(paths[name], t_s), scene.color(own))
