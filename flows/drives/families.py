"""`sgcad vary`: a case's family on disk, and its hardest members for a driver.

    vary/seed-<n>/  manifest.json   every parameter with its reason, every member with its values
                    logical.xosc, deterministic.xosc, stochastic.xosc
                    concrete/0001.xosc ...
                    hardest.json, decides.png   with --driver: rates, weights, which parameter decides

Knows the family's functions and file formats; no plugin by name.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flows import store
from flows.drives.reading import SURFACES, egos, script_of
from sgcad_core import scratch
from sgcad_core.config import DriverEntry
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.formats.openscenario.logical import Meets, Range, deterministic, logical_xosc, stochastic
from sgcad_core.formats.openscenario.writer import write_xosc
from sgcad_core.handover.drive import drive
from sgcad_core.handover.hardest import Searched, decides, search
from sgcad_core.handover.outcome import Came, came
from sgcad_core.handover.script import Script, staged
from sgcad_core.handover.spread import Parameter, spreads
from sgcad_core.handover.variant import Basis, basis_of, member, prolonged, undisturbed
from sgcad_core.records import Floats
from sgcad_core.specs import BehaviorSpec

TRIES = 40
"""Draws a member at most: a family of which fewer are the same crash is too wide."""
ROUNDS = 5
BACK = 0.45
"""Straight run before the logical file's trajectories, of the time to the contact: the fastest pace needs 0.4."""


@dataclass(frozen=True)
class Family:
    """A case ready to be varied."""

    folder: Path
    basis: Basis
    parameters: tuple[Parameter, ...]
    facts: tuple[Mapping[str, Any], ...]

    def values(self, latent: Floats) -> dict[str, float]:
        """Parameter values of a latent vector."""
        return {p.name: round(p.value(float(z)), 6) for p, z in zip(self.parameters, latent, strict=True)}


def family_of(folder: Path, role_of: Mapping[str, str] | None = None) -> Family:
    """The family of a finished case. Raises BadInput for one that does not crash as declared."""
    script = script_of(folder, role_of)
    basis = basis_of(script)
    if basis is None:
        raise BadInput(f"{folder}: its first contact is not the declared one, or of no vehicle; nothing to vary about")
    facts = tuple(json.loads((folder / "result.json").read_text(encoding="utf-8")).get("facts", ()))
    return Family(folder, basis, spreads(script, facts), facts)


def vary(family: Family, count: int, seed: int, driver: DriverEntry | None = None, role: str = "") -> Path:
    """Write a family of so many members; the folder. Raises BadInput, ConfigError, SimulationFailed."""
    place = family.folder / "vary" / f"seed-{seed}"
    place.parent.mkdir(parents=True, exist_ok=True)
    with scratch.beside(place) as partial:
        partial.chmod(0o755)
        _write(family, count, seed, partial)
        if driver is not None:
            _hardest(family, count, seed, driver, role, partial)
        shutil.rmtree(place, ignore_errors=True)
        partial.rename(place)
    return place


# ------------------------------------------------------------------ members
def members(family: Family, count: int, seed: int) -> tuple[list[tuple[dict[str, float], Script]], int]:
    """So many members with their values, and how many draws that took. Raises BadInput where too few are the same."""
    rng = np.random.default_rng(seed)
    found: list[tuple[dict[str, float], Script]] = []
    drawn = 0
    while len(found) < count:
        drawn += 1
        values = family.values(rng.standard_normal(len(family.parameters)))
        if (made := member(family.basis, values)) is not None:
            found.append((values, made))
        elif drawn > TRIES * (len(found) + 5):
            raise BadInput(f"{family.folder}: of {drawn} draws only {len(found)} are the same crash; nothing to vary")
    return found, drawn


def _write(family: Family, count: int, seed: int, place: Path) -> None:
    found, drawn = members(family, count, seed)
    (place / "concrete").mkdir()
    behavior = _conditions(family)
    for number, (_, made) in enumerate(found, 1):
        text = write_xosc(made.actors, made.trajectories, behavior, "../../../road.xodr", f"member {number}")
        (place / "concrete" / f"{number:04d}.xosc").write_text(text, encoding="utf-8")
    ranges = [_range(p) for p in family.parameters]
    (place / "logical.xosc").write_text(_logical(family, ranges, behavior), encoding="utf-8")
    sets = [values for values, _ in found]
    (place / "deterministic.xosc").write_text(deterministic("logical.xosc", sets), encoding="utf-8")
    (place / "stochastic.xosc").write_text(stochastic("logical.xosc", ranges, count, seed), encoding="utf-8")
    store.write_json(place / "manifest.json", _manifest(family, found, drawn, seed))


def _conditions(family: Family) -> BehaviorSpec:
    """Light, weather and surface as read: all that a scenario file takes of a behavior."""
    told = {f["field"].split(".")[1]: f["value"] for f in family.facts if f["field"].startswith("conditions.")}
    surface = told.get("surface") if told.get("surface") in SURFACES else None
    weather, light = told.get("weather"), told.get("light")
    return BehaviorSpec.model_construct(actors=(), contacts=(), light=light, weather=weather, surface=surface)


def _range(p: Parameter) -> Range:
    return Range(p.name, p.nominal, p.low, p.high, p.mean, p.spread if p.kind == "normal" else 0.0)


def _logical(family: Family, ranges: Sequence[Range], behavior: BehaviorSpec) -> str:
    basis = family.basis
    nominal = undisturbed(basis, {p.name: p.nominal for p in family.parameters})
    back = round(BACK * basis.contact_s / 0.05) * 0.05
    text = write_xosc(nominal.actors, prolonged(nominal, back), behavior, "../../road.xodr", "logical")
    everybody = [Meets(t.actor, basis.contact_s + back) for t in nominal.trajectories]
    return logical_xosc(text, ranges, everybody, basis.contact_s)


def _manifest(
    family: Family, found: Sequence[tuple[dict[str, float], Script]], drawn: int, seed: int
) -> dict[str, Any]:
    """Of every value whether it is a fact of the report, inferred, or varied."""
    script = family.basis.script
    return {
        "case": script.case, "seed": seed, "count": len(found), "drawn": drawn,
        "declared": script.declared.model_dump() if script.declared else None,
        "parameters": [{**p.model_dump(), "value": "varied"} for p in family.parameters],
        "kept": [
            {"field": f["field"], "value": f["value"], "value_is": _standing(f)} for f in family.facts
        ],
        "members": [
            {"file": f"concrete/{number:04d}.xosc", "values": values} for number, (values, _) in enumerate(found, 1)
        ],
        "not_varied": "lanes, reactions and light: another lane or light would contradict what was planned with it; "
                      "reactions are the driver's (`sgcad drive`)",
    }  # fmt: skip


def _standing(fact: Mapping[str, Any]) -> str:
    return {"stated": "report fact", "inferred": "inferred"}.get(str(fact.get("status")), "default")


# ------------------------------------------------------------------ the hardest
def _hardest(family: Family, count: int, seed: int, driver: DriverEntry, role: str, place: Path) -> None:
    wanted = egos(family.basis.script, "", [role])
    if not wanted:
        raise ConfigError(f"{family.folder}: nobody who can be driven is its {role}; give --role")
    ego = wanted[0][0]
    seen: list[Came | None] = []
    found = search(_hardness(family, driver, ego, seen), len(family.parameters), count, ROUNDS, seed)
    share = decides(found.latents, found.hardness)
    store.write_json(place / "hardest.json", _told(family, driver, (ego, role), found, seen) | {
        "decides": {p.name: round(float(v), 4) for p, v in zip(family.parameters, share, strict=True)},
    })  # fmt: skip
    (place / "decides.png").write_bytes(_plot(family.parameters, share, f"{driver.label} drives {ego}"))


def _hardness(
    family: Family, driver: DriverEntry, ego: str, seen: list[Came | None]
) -> Callable[[Floats], float | None]:
    """How hard a member is: the larger delta-v where the ego touches, else minus its least clearance."""

    def hardness(latent: Floats) -> float | None:
        made = undisturbed(family.basis, family.values(latent))
        if member(family.basis, family.values(latent)) is None:
            seen.append(None)
            return None
        result = came(drive(staged(made, ego), driver.driver))
        seen.append(result)
        if result.outcome == "lost":
            return None
        return result.severity.worst_delta_v_mps if result.severity else -result.closest_m

    return hardness


def _told(
    family: Family, driver: DriverEntry, who: tuple[str, str], found: Searched, seen: Sequence[Came | None]
) -> dict[str, Any]:
    same = np.array([c is not None for c in seen])
    touched = np.array([c is not None and c.contact is not None for c in seen])
    inside = found.rate(same)[0]
    rate, error = found.rate(touched)
    order = np.argsort(-found.hardness, kind="stable")[:10]
    return {
        "driver": driver.label, "fields": driver.raw, "ego": who[0], "role": who[1], "samples": len(seen),
        "members": int(same.sum()), "effective_samples": round(found.effective, 1),
        "contact_rate": round(rate / inside, 4) if inside > 0 else None,
        "contact_rate_error": round(error / inside, 4) if inside > 0 else None,
        "hardest": [
            {"values": family.values(found.latents[k]), "hardness": round(float(found.hardness[k]), 4),
             "weight": round(float(found.weights[k]), 6), "outcome": one.outcome}
            for k in order if (one := seen[k]) is not None and np.isfinite(found.hardness[k])
        ],
    }  # fmt: skip


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
