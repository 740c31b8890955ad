"""Figures of numbers: sensitivity to a varied key, risk distribution, displacement errors.

A figure without data says why. Measured and published values are drawn apart.
"""

from __future__ import annotations

import io
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flows.player.player_data import COLORS
from flows.results.arm_displacement import displacements_from, no_displacement_reason
from flows.results.measures import GENERATION, NETWORK_WRONG, Measure
from flows.results.reading import Arm
from flows.results.table import Tables, reference_of
from flows.study.published import publication
from sgcad_core.metrics import statistics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 130
MOST_ARMS = 12
DASHES = ("-", (0, (5, 2)), (0, (2, 2)), (0, (6, 2, 1, 2)))
"""Line styles: arms that agree stay visible over one another."""
LEVELS = ("critical", "high", "moderate_low")
LEVEL_COLORS = {"critical": "#b3202c", "high": "#e08a3c", "moderate_low": "#b9c4c9"}
SENSITIVE: tuple[Measure, ...] = (*NETWORK_WRONG, *(m for m in GENERATION if m.name in ("generated", "as_declared")))


@dataclass(frozen=True)
class Plot:
    """A figure, or the reason why there is none."""

    key: str
    title: str
    caption: str
    png: bytes | None = None
    reason: str = ""


def canvas(width_in: float, height_in: float) -> Figure:
    """An empty figure in the project's look, drawn without a display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def as_png(figure: Figure) -> bytes:
    """The figure's bytes."""
    out = io.BytesIO()
    figure.savefig(out, format="png", pil_kwargs={"compress_level": 6})
    return out.getvalue()


def plain(axes: Axes, title: str = "") -> None:
    """No box, faint grid, the title to the left."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color="#e4e7e4", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8)
    if title:
        axes.set_title(title, loc="left", fontsize=9.5, fontweight="bold", parse_math=False)


def plots_of(tables: Tables) -> list[Plot]:
    """Every figure of numbers."""
    return [sensitivity(tables), risk(tables), displacement(tables)]


# ------------------------------------------------------------------ sensitivity
def sensitivity(tables: Tables) -> Plot:
    """Figures over the values of a key that arms vary in three or more numbers; seeds are averaged case by case."""
    title = "Sensitivity"
    key = varied_key([arm.factors for arm in tables.study.arms])
    if key is None:
        return Plot("sensitivity", title, "", reason="no key takes three or more numbers over the arms")
    lines = _lines(tables.study.arms, key)
    shown = [m for m in SENSITIVE if any(m.key in v for cases in tables.values.values() for v in cases.values())]
    figure = canvas(3.1 * len(shown), 3.0)
    for k, measure in enumerate(shown):
        axes = figure.add_subplot(1, len(shown), k + 1)
        plain(axes, f"{measure.label} (%)")
        axes.set_xlabel(key, fontsize=8.5, parse_math=False)
        for color, (label, points) in zip(COLORS * 9, lines.items(), strict=False):
            _line(axes, [(x, pooled(tables, arms, measure)) for x, arms in sorted(points.items())], color, label)
        axes.set_ylim(-3, 103)
    if len(lines) > 1:
        figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", fontsize=8, ncols=3)
    caption = (
        f"Over {key}; ICE, LCE and CE as share of reports with any error. Bars: 95 % bootstrap interval over cases, "
        "seeds averaged within a case."
    )
    return Plot("sensitivity", f"Sensitivity to {key}", caption, as_png(figure))


def varied_key(factors: Sequence[Mapping[str, Any]]) -> str | None:
    """The varied key with the most distinct numbers, three at least; seeds do not count."""
    numbers: dict[str, set[float]] = defaultdict(set)
    for one in factors:
        for key, value in one.items():
            if isinstance(value, int | float) and not isinstance(value, bool) and key != "seed":
                numbers[key].add(float(value))
    best = max(numbers, key=lambda k: len(numbers[k]), default=None)
    return best if best is not None and len(numbers[best]) >= 3 else None


def _lines(arms: Iterable[Arm], key: str) -> dict[str, dict[float, list[str]]]:
    """Label of the other factors -> value of the key -> arms (one a seed)."""
    lines: dict[str, dict[float, list[str]]] = defaultdict(lambda: defaultdict(list))
    for arm in arms:
        if isinstance(arm.factors.get(key), int | float):
            rest = ", ".join(f"{k}={v}" for k, v in arm.factors.items() if k not in (key, "seed"))
            lines[rest or arm.config][float(arm.factors[key])].append(arm.name)
    return lines


def pooled(tables: Tables, arms: Sequence[str], measure: Measure) -> list[float]:
    """One value per case: the mean over arms that differ only in the seed."""
    found: dict[str, list[float]] = defaultdict(list)
    for arm in arms:
        for case, values in tables.values[arm].items():
            if measure.key in values:
                found[case].append(values[measure.key])
    return [float(np.mean(v)) for v in found.values()]


def _line(axes: Axes, points: list[tuple[float, list[float]]], color: str, label: str) -> None:
    known = [(x, values) for x, values in points if values]
    if not known:
        return
    x = [p[0] for p in known]
    middle = [100 * float(np.mean(values)) for _, values in known]
    ends = [statistics.share_interval(v) if set(v) <= {0.0, 1.0} else statistics.mean_interval(v) for _, v in known]
    low = [m - 100 * e.low if e else 0.0 for m, e in zip(middle, ends, strict=True)]
    high = [100 * e.high - m if e else 0.0 for m, e in zip(middle, ends, strict=True)]
    bars = np.maximum([low, high], 0)
    axes.errorbar(x, middle, yerr=bars, color=color, marker="o", markersize=4, linewidth=1.6, capsize=2.5, label=label)


# ------------------------------------------------------------------ risk
def risk(tables: Tables) -> Plot:
    """Levels of S_e by arm in both readings, the published distribution below them where an arm names one."""
    title = "Risk distribution"
    arms = [a for a in tables.study.arms if any("x_critical" in v for v in tables.values[a.name].values())][:MOST_ARMS]
    if not arms:
        return Plot("risk", title, "", reason="no case was executed")
    told = [row for a in arms if (row := publication().row(a.published)) and "p_critical" in row.figures]
    published = {row.label: row for row in told}
    figure = canvas(9.0, 1.2 + 0.34 * (len(arms) + len(published)))
    for k, (reading, prefix) in enumerate((("exact", "x"), ("paper", "p"))):
        axes = figure.add_subplot(1, 2, k + 1)
        plain(axes, f"`{reading}` reading")
        rows = [(a.label, _levels(tables, a.name, prefix), False) for a in arms]
        if prefix == "p":
            rows += [
                (f"published: {name}", [row.figures[f"p_{k}"].value for k in LEVELS], True)
                for name, row in published.items()
            ]
        _stack(axes, rows)
    figure.axes[0].legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3, fontsize=8, frameon=False)
    caption = "Share of generated scenarios at each level of the emergency score S_e. Hatched: published values."
    return Plot("risk", title, caption, as_png(figure))


def _levels(tables: Tables, arm: str, prefix: str) -> list[float]:
    cases = [v for v in tables.values[arm].values() if f"{prefix}_critical" in v]
    return [100 * float(np.mean([v[f"{prefix}_{level}"] for v in cases])) if cases else 0.0 for level in LEVELS]


def _stack(axes: Axes, rows: list[tuple[str, list[float], bool]]) -> None:
    left = np.zeros(len(rows))
    for j, level in enumerate(LEVELS):
        widths = np.array([shares[j] for _, shares, _ in rows])
        bars = axes.barh(
            range(len(rows)), widths, left=left, color=LEVEL_COLORS[level], label=level.replace("_", " and ")
        )
        for i, bar in enumerate(bars):
            bar.set_hatch("///" if rows[i][2] else "")
            bar.set_edgecolor("white")
            if widths[i] >= 9:
                ink = "white" if level == "critical" else "#22282d"
                axes.text(left[i] + widths[i] / 2, i, f"{widths[i]:.0f}", ha="center", va="center", color=ink, size=7.5)
        left += widths
    axes.set_yticks(range(len(rows)), [label for label, *_ in rows], fontsize=8, parse_math=False)
    axes.invert_yaxis()
    axes.set_xlim(0, 100)
    axes.grid(visible=False)


# ------------------------------------------------------------------ displacement
def displacement(tables: Tables) -> Plot:
    """Prediction error of the motion by arm, and its displacement from the reference arm's."""
    title = "Displacement errors"
    predicted = {a.label: _values(tables, a.name, "x_fde") for a in tables.study.arms[:MOST_ARMS]}
    if not any(predicted.values()):
        return Plot("displacement", title, "", reason="no case was executed")
    apart = displacements_from(tables.study, reference_of(tables.study))
    figure = canvas(10.0, 3.2)
    panels: list[tuple[str, str, Mapping[str, Sequence[float]]]] = [("Prediction error over 3 s: FDE", "m", predicted)]
    if apart:
        panels.append(("Against the reference arm: ADE", "m", {k: [e.average_m for e in v] for k, v in apart.items()}))
        panels.append(("Against the reference arm: FDE", "m", {k: [e.final_m for e in v] for k, v in apart.items()}))
    for k, (name, unit, groups) in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), k + 1)
        plain(axes, name)
        axes.set_xlabel(unit, fontsize=8.5)
        axes.set_ylabel("cases", fontsize=8.5)
        _histogram(axes, groups, {a.label: c for a, c in zip(tables.study.arms, COLORS * 9, strict=False)}.__getitem__)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    caption = (
        "Left: error of a constant-velocity prediction, `exact` reading. "
        + (no_displacement_reason(tables.study) if not apart else "Right: no trajectory is published, so arms are "
           "held against the reference arm, case by case: both runs are laid over each other at V1's pose at the first "
           "contact, and vehicles of the same id compared over the 3 s before it, FDE at its far end.")
    )  # fmt: skip
    return Plot("displacement", title, caption, as_png(figure))


def _values(tables: Tables, arm: str, key: str) -> list[float]:
    return [v[key] for v in tables.values[arm].values() if key in v]


def _histogram(axes: Axes, groups: Mapping[str, Sequence[float]], color: Callable[[str], str]) -> None:
    everything = [v for values in groups.values() for v in values]
    edges = np.linspace(0, max(max(everything, default=1.0), 1e-3) * 1.001, 21)
    for k, (label, values) in enumerate(groups.items()):
        if values:
            bins, shade, dashes = edges.tolist(), color(label), DASHES[k % len(DASHES)]
            axes.hist(values, bins=bins, histtype="stepfilled", alpha=0.15, color=shade)
            axes.hist(values, bins=bins, histtype="step", linewidth=1.7, linestyle=dashes, color=shade, label=label)
    axes.locator_params(axis="y", integer=True)
