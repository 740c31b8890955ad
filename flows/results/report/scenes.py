"""Figures of cases: networks side by side, and frames of one crash in every arm."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flows.player.overview_png import GROUND, RED
from flows.results.reading import FinishedCase, Study, made_of
from flows.results.report.axes import SIDE_IN, bare, car, look, say, star, under
from flows.results.report.plots import Plot, as_png, canvas
from flows.results.report.scene import scene_of
from flows.results.table import Tables
from sgcad_core.metrics.labels.label_match import compare, truth_figures
from sgcad_core.reading.text.normalise import sentences
from sgcad_core.result import as_declared
from sgcad_core.system.pictures import opened

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_ARMS, MOST_ROWS = 6, 4
"""Arms in a row of networks and rows of it; arms in the frames."""
MOMENTS_S = (-3.0, -1.0, 0.0, 0.5)
"""Frames, in seconds from the first contact."""
NEAR_M = 28.0
GOOD, BAD = "#1b7f4d", "#c4203a"
MARKS = (
    ("initial_heading", "headings"), ("maneuver", "maneuvers"), ("collision_pair", "first contact pair"),
    ("collision_areas", "on which sides"),
)  # fmt: skip


def scenes_of(tables: Tables) -> list[Plot]:
    """Both figures of cases."""
    return [networks(tables), frames(tables)]


# ------------------------------------------------------------------ networks
def networks(tables: Tables, cases: Sequence[str] = ()) -> Plot:
    """Diagram, truth and every arm's network side by side, for a few cases: those on which arms differ come first."""
    study, title = tables.study, "Networks side by side"
    arms = study.arms[:MOST_ARMS]
    chosen = list(cases) or _telling(tables)[:MOST_ROWS]
    if not chosen:
        return Plot("networks", title, "", reason="no arm wrote a network")
    figure = canvas(SIDE_IN * (len(arms) + 2), SIDE_IN * 1.18 * len(chosen))
    for row, case in enumerate(chosen):
        wide = len(arms) + 2
        grid = [figure.add_subplot(len(chosen), wide, row * wide + k + 1) for k in range(wide)]
        _diagram(grid[0], study, case)
        _truth(grid[1], study.labels.get(case))
        for axes, arm in zip(grid[2:], arms, strict=True):
            _network(axes, study.ran[arm.name].get(case), study.labels.get(case))
        if row == 0:
            for axes, head in zip(grid, ("Diagram", "Truth", *(a.label for a in arms)), strict=True):
                axes.set_title(head, fontsize=9, fontweight="bold", parse_math=False)
    left = f"; {len(study.arms) - MOST_ARMS} more arms are left out" if len(study.arms) > MOST_ARMS else ""
    caption = f"Cases on which the arms differ most come first. Green: counts as the truth has them, red: not{left}."
    return Plot("networks", title, caption, as_png(figure))


def _telling(tables: Tables) -> list[str]:
    """Cases with a network in some arm, those with the widest spread of errors first, with a diagram before without."""
    study = tables.study

    def rank(case: str) -> tuple[float, bool]:
        seen = [tables.values[a.name].get(case, {}) for a in study.arms]
        marks = [sum(v.get(f"{k}_error", 0.0) for k in ("intersections", "lanes")) for v in seen]
        drawn = any((study.folder / a.name / case / "diagram.png").is_file() for a in study.arms)
        return -float(np.ptp(marks)) if marks else 0.0, not drawn

    written = [c for c in study.cases if any(r[c].generated for r in study.ran.values() if c in r)]
    return sorted(written, key=rank)


def _diagram(axes: Axes, study: Study, case: str) -> None:
    bare(axes)
    file = next((f for a in study.arms if (f := study.folder / a.name / case / "diagram.png").is_file()), None)
    if file is None:
        say(axes, "no diagram")
    else:
        with opened(file) as image:
            image.thumbnail((480, 480))
            axes.imshow(np.asarray(image.convert("RGB")))
    under(axes, case)


def _truth(axes: Axes, label: Mapping[str, Any] | None) -> None:
    """The label's nodes and segments as a sketch with lanes there / back, or in words where it has none."""
    bare(axes)
    if label is None:
        return say(axes, "no truth")
    nodes = {n["id"]: (n["x"], -n["y"]) for n in label["network"].get("nodes") or () if n.get("x") is not None}
    segments = [s for s in label["network"].get("segments") or () if {s["from"], s["to"]} <= set(nodes)]
    if not segments:
        return say(axes, _truth_words(label))
    for s in segments:
        a, b = np.array(nodes[s["from"]]), np.array(nodes[s["to"]])
        lanes = (s.get("lanes_towards_to") or 0, s.get("lanes_towards_from") or 0)
        axes.plot(*np.stack((a, b)).T, color="#8a929a", linewidth=2.2 * sum(lanes), solid_capstyle="round", zorder=1)
        axes.annotate(f"{lanes[0]}/{lanes[1]}", (a + b) / 2, ha="center", va="center", size=7, zorder=3).set_bbox(
            {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"}
        )
    axes.set_box_aspect(1)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    figures = truth_figures(label)
    return under(axes, f"junctions {figures.intersections}, mean lanes {figures.mean_lanes or 0:.2f}")


def _truth_words(label: Mapping[str, Any]) -> str:
    """The statements of a coded label on the road."""
    network = label["network"]
    told = [f"junctions: {network.get('intersections')}", str(network.get("layout_best") or "").replace("_", " ")]
    told += [f"{r.get('vehicle')}: {r['lanes_total']} lanes" for r in network.get("roads", ()) if r.get("lanes_total")]
    return "\n".join(told)


def _network(axes: Axes, ran: FinishedCase | None, label: Mapping[str, Any] | None) -> None:
    bare(axes)
    axes.set_facecolor(GROUND)
    scene = scene_of(ran) if ran else None
    if ran is None:
        return say(axes, "not done yet")
    if scene is None:
        return say(axes, f"{ran.result['status']}\n{ran.result['reason'][:90]}", BAD)
    look(axes, scene, scene.middle, scene.half_m)
    for track in scene.paths.values():
        axes.plot(track.pose[:, 0], track.pose[:, 1], color=scene.color(track), linewidth=1.1, zorder=3)
    found = ran.result.get("network") or {}
    text = f"junctions {found.get('intersections')}, mean lanes {found.get('mean_lanes', 0):.2f}"
    if label is None:
        return under(axes, text)
    marks = compare(label, made_of(ran.folder, ran.result))
    wrong = [v for k, v in marks.items() if k.endswith("error_any")] + [1 - marks.get("lanes_total", 1.0)]
    return under(axes, text, BAD if any(wrong) else GOOD)


# ------------------------------------------------------------------ frames
def frames(tables: Tables, case: str = "") -> Plot:
    """One crash at four moments in every arm, under the report's own sentences, with what agrees with the truth."""
    study, title = tables.study, "One crash across the arms"
    chosen = case or _crash(study)
    if not chosen:
        return Plot("frames", title, "", reason="no case was executed in any arm")
    arms = study.arms[:MOST_ARMS]
    figure = canvas(SIDE_IN * len(MOMENTS_S) + 2.6, SIDE_IN * len(arms) + 1.2)
    top = figure.add_subfigure(figure.add_gridspec(2, 1, height_ratios=(1.2, SIDE_IN * len(arms)))[0])
    body = figure.add_subfigure(figure.add_gridspec(2, 1, height_ratios=(1.2, SIDE_IN * len(arms)))[1])
    folder = next(study.ran[a.name][chosen].folder for a in arms if chosen in study.ran[a.name])
    story = _story((folder / "report.txt").read_text(encoding="utf-8"))
    top.text(0.01, 0.92, f"{chosen}\n{story}", va="top", size=8, linespacing=1.35, parse_math=False)
    grid = body.subplots(len(arms), len(MOMENTS_S) + 1, squeeze=False, width_ratios=(2.3, *[SIDE_IN] * len(MOMENTS_S)))
    for axes, arm in zip(grid, arms, strict=True):
        ran = study.ran[arm.name].get(chosen)
        _verdicts(axes[0], arm.label, ran, study.labels.get(chosen))
        _moments(axes[1:], ran)
    caption = "Seconds count from each arm's first contact. Green agrees with the truth, red does not."
    return Plot("frames", title, caption, as_png(figure))


def _crash(study: Study) -> str:
    """The case executed in most arms, with the most vehicles; of these the first."""

    def rank(case: str) -> tuple[int, int]:
        runs = [study.ran[a.name][case] for a in study.arms if case in study.ran[a.name]]
        hits = [r for r in runs if r.generated and (r.result.get("collision") or {}).get("observed")]
        return len(hits), max((min(len(r.result.get("actors", ())), 3) for r in hits), default=0)

    best = max(study.cases, key=rank, default="")
    return best if best and rank(best)[0] else ""


def _story(report: str, most: int = 4, width: int = 150) -> str:
    """The sentences that tell the crash: those of the narrative that name a vehicle and what it did."""
    told = [s.text for s in sentences(report) if s.role in ("approach", "avoidance", "impact")]
    lines = told[:most] or [report[:400]]
    return "\n".join(textwrap.fill("• " + " ".join(line.split()), width, subsequent_indent="  ") for line in lines)


def _verdicts(axes: Axes, label: str, ran: FinishedCase | None, truth: Mapping[str, Any] | None) -> None:
    axes.set_axis_off()
    axes.text(0, 0.96, textwrap.fill(label, 24), va="top", size=9, weight="bold", parse_math=False)
    if ran is None:
        axes.text(0, 0.7, "not done yet", size=8, color="#66707a")
        return
    hit, what = as_declared(ran.result), "near crash" if ran.result.get("near_crash") else "first contact"
    lines = [(f"{what} {'' if hit else 'not '}as declared", bool(hit))] if ran.generated else []
    if truth is not None:
        marks = compare(truth, made_of(ran.folder, ran.result))
        lines += [(name, marks[key] == 1.0) for key, name in MARKS if key in marks]
    for k, (text, right) in enumerate(lines):
        sign = "✓" if right else "✗"
        axes.text(0, 0.74 - 0.13 * k, f"{sign} {text}", size=8, color=GOOD if right else BAD, parse_math=False)


def _moments(grid: Sequence[Axes], ran: FinishedCase | None) -> None:
    scene = scene_of(ran) if ran else None
    for axes, moment in zip(grid, MOMENTS_S, strict=True):
        bare(axes)
        axes.set_facecolor(GROUND)
        if ran is None or scene is None or scene.contact_s is None:
            say(axes, "" if ran is None else ran.result["status"] if scene is None else "nothing touched", BAD)
            continue
        look(axes, scene, scene.contact_at, NEAR_M)
        for track in scene.paths.values():
            box = scene.box(track, scene.contact_s + moment)
            car(axes, box, scene.color(track))
        if moment >= 0:
            star(axes, scene.contact_at, RED)
        under(axes, f"{moment:+.1f} s".replace("-", "−") if moment else "first contact")
