"""The hardest members of a family for a driver: hardest.json and decides.png.

Cross-entropy converges to the one hardest region. MAP-Elites keeps the hardest member of every cell of two descriptors,
closing speed and time to collision at the start of braking. Both estimate rates within the family by importance
weights.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from flows.case_files import case_folder
from flows.drive.families import Family
from flows.drive.script_of_case import egos
from sgcad_core.case.records import Floats
from sgcad_core.config import DriverEntry
from sgcad_core.errors import ConfigError
from sgcad_core.handover.drive import drive
from sgcad_core.handover.family.cross_entropy import Searched, rank_correlations, search
from sgcad_core.handover.family.map_elites import Cell, illuminate
from sgcad_core.handover.family.parameter import Parameter
from sgcad_core.handover.family.variant import member, undisturbed
from sgcad_core.handover.outcome import DriveResult, judge_drive
from sgcad_core.handover.rules_of_drive import broken_by
from sgcad_core.handover.script import staging_for

Method = Literal["cross-entropy", "map-elites"]
METHODS: tuple[Method, ...] = ("cross-entropy", "map-elites")
ROUNDS = 5
CLOSING_MPS = 2.5
"""Width of a cell in closing speed."""
TTC_S = (0.5, 1.0, 1.5, 2.0, 3.0)
"""Between cells of the time to collision at which braking began; a drive without braking has a cell of its own."""
TOLD = 10


class Search(NamedTuple):
    """A search for the hardest members for a driver in a role, by one of the two methods."""

    driver: DriverEntry
    role: str
    method: Method = "cross-entropy"


def hardest(family: Family, count: int, seed: int, look: Search, place: Path) -> None:
    """Search, and write the result. Raises ConfigError where no actor has the role, SimulationFailed."""
    wanted = egos(family.basis.script, "", [look.role])
    if not wanted:
        raise ConfigError(f"{family.folder}: no actor that can be driven has the role {look.role}; give another --role")
    ego, seen = wanted[0][0], list[DriveResult | None]()
    drives = _driven(family, look, ego, seen)
    dimensions, told = len(family.parameters), {}
    if look.method == "map-elites":
        lit = illuminate(lambda z: _judged(drives(z)), dimensions, count, seed)
        found = lit.samples
        told = {"elites": [_elite(family, found, seen, k) | _cell(cell) for cell, k in sorted(lit.elites.items())]}
    else:
        found = search(lambda z: _hardness(drives(z)), dimensions, count, ROUNDS, seed)
    share = rank_correlations(found.latents, found.hardness)
    names = {p.name: round(float(v), 4) for p, v in zip(family.parameters, share, strict=True)}
    about = {
        "driver": look.driver.label,
        "fields": look.driver.raw,
        "ego": ego,
        "role": look.role,
        "search": look.method,
    }
    case_folder.write_json(place / "hardest.json", about | _rates(family, found, seen) | told | {"decides": names})
    (place / "decides.png").write_bytes(_plot(family.parameters, share, f"{look.driver.label} drives {ego}"))


# ------------------------------------------------------------------ one sample
def _driven(
    family: Family, look: Search, ego: str, seen: list[DriveResult | None]
) -> Callable[[Floats], DriveResult | None]:
    """A function that drives a sample; None: no member of the family, or lost. Every result is kept in `seen`."""

    def driven(latent: Floats) -> DriveResult | None:
        values = family.values(latent)
        result = None
        if member(family.basis, values) is not None:
            result = judge_drive(drive(staging_for(undisturbed(family.basis, values), ego), look.driver.driver))
        seen.append(result)
        return result if result is not None and result.outcome != "lost" else None

    return driven


def _hardness(result: DriveResult | None) -> float | None:
    """The larger delta-v where the ego touches, else minus its least clearance; None without a result."""
    if result is None:
        return None
    return result.severity.worst_delta_v_mps if result.severity else -result.closest_m


def _judged(result: DriveResult | None) -> tuple[float, Cell] | None:
    hardness = _hardness(result)
    if result is None or hardness is None:
        return None
    closing = result.scripted.closing_mps if result.scripted else 0.0
    ttc = result.braked_at_ttc_s
    braked = -1 if result.braked_s is None else len(TTC_S) if ttc is None else bisect_right(TTC_S, ttc)
    return hardness, (int(closing // CLOSING_MPS), braked)


# ------------------------------------------------------------------ told
def _rates(family: Family, found: Searched, seen: Sequence[DriveResult | None]) -> dict[str, Any]:
    same = np.array([c is not None for c in seen])
    touched = np.array([c is not None and c.contact is not None for c in seen])
    breaks = np.array([bool(_broken(c)) for c in seen])
    inside = found.rate(same)[0]
    rate, error = found.rate(touched)
    order = [int(k) for k in np.argsort(-found.hardness, kind="stable") if np.isfinite(found.hardness[k])]
    return {
        "samples": len(seen), "members": int(same.sum()), "effective_samples": round(found.effective, 1),
        "contact_rate": round(rate / inside, 4) if inside > 0 else None,
        "contact_rate_error": round(error / inside, 4) if inside > 0 else None,
        "rule_rate": round(found.rate(breaks)[0] / inside, 4) if inside > 0 else None,
        "hardest_by_rules": [_elite(family, found, seen, k) for k in _by_rules(found, seen)[:TOLD]],
        "hardest": [_elite(family, found, seen, k) for k in order[:TOLD]],
    }  # fmt: skip


def _elite(family: Family, found: Searched, seen: Sequence[DriveResult | None], k: int) -> dict[str, Any]:
    one = seen[k]
    return {
        "values": family.values(found.latents[k]), "hardness": round(float(found.hardness[k]), 4),
        "weight": round(float(found.weights[k]), 6), "outcome": one.outcome if one else "",
        "rules": _broken(one),
    }  # fmt: skip


def _broken(one: DriveResult | None) -> list[str]:
    """Rules that the ego broke in a sample."""
    return list(broken_by(one.rules, one.ego)) if one else []


def _by_rules(found: Searched, seen: Sequence[DriveResult | None]) -> list[int]:
    """Samples in which the ego broke a rule: the most rules first, of as many the hardest."""
    counts = {k: len(_broken(one)) for k, one in enumerate(seen) if np.isfinite(found.hardness[k])}
    return sorted((k for k, n in counts.items() if n), key=lambda k: (-counts[k], -float(found.hardness[k]), k))


def _cell(cell: Cell) -> dict[str, Any]:
    """A cell in words: closing speed from and to, and when braking began."""
    speed, braked = cell
    ends = (0.0, *TTC_S)
    word = "never" if braked < 0 else f"{ends[braked]:g} s and more" if braked + 1 >= len(ends) else (
        f"{ends[braked]:g} to {ends[braked + 1]:g} s"
    )  # fmt: skip
    return {"closing_mps": [speed * CLOSING_MPS, (speed + 1) * CLOSING_MPS], "braked_at_ttc": word}


def _plot(parameters: Sequence[Parameter], share: Floats, title: str) -> bytes:
    import io

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 0.4 * len(parameters) + 1.4), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    order = np.argsort(np.abs(share))
    axes.barh([parameters[k].name for k in order], share[order], color="#0072b2")
    axes.axvline(0, color="#2d3436", linewidth=0.8)
    axes.set(xlim=(-1, 1), xlabel="rank correlation with hardness", title=title)
    out = io.BytesIO()
    figure.savefig(out, format="png")
    return out.getvalue()
