"""`sgcad vary`: a case's family on disk, and its hardest members for a driver.

    vary/seed-<n>/  manifest.json   every parameter with its reason, every member with its values
                    logical.xosc, deterministic.xosc, stochastic.xosc
                    concrete/0001.xosc ...
                    hardest.json, decides.png   with --driver (flows/drive/hardest_search): rates, weights, what decides

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

from flows.case_files import case_folder
from flows.drive.script_of_case import SURFACES, script_of
from sgcad_core.case.records import Floats
from sgcad_core.errors import BadInput
from sgcad_core.formats.openscenario.writing.entities import SUNS
from sgcad_core.formats.openscenario.writing.logical import (
    ParameterizedActor,
    ParameterRange,
    TimeShift,
    deterministic_distribution,
    logical_xosc,
    stochastic_distribution,
    with_sun_parameter,
)
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.handover.family.discrete_parameters import LIGHTS, PAIR, light_of, unvaried
from sgcad_core.handover.family.parameter import Parameter
from sgcad_core.handover.family.parameter_priors import open_parameters
from sgcad_core.handover.family.shifted_evasion import LATER_S
from sgcad_core.handover.family.variant import FamilyBasis, basis_of, member, undisturbed, with_earlier_start
from sgcad_core.handover.script import Script
from sgcad_core.records.specs import BehaviorSpec
from sgcad_core.system import temp_folders
from sgcad_core.system.private_folders import open_as_parent

TRIES = 40
"""Maximum draws per member: a family with fewer draws that are the same crash is too wide."""
BACK = 0.45
"""Straight run before the logical file's trajectories, of the time to the contact: the fastest pace needs 0.4."""


@dataclass(frozen=True)
class Family:
    """A case to be varied: its basis and its parameters."""

    folder: Path
    basis: FamilyBasis
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
        raise BadInput(
            f"{folder}: its first contact is not the declared one, or has no vehicle, so it cannot be varied"
        )
    facts = tuple(json.loads((folder / "result.json").read_text(encoding="utf-8")).get("facts", ()))
    return Family(folder, basis, open_parameters(script, facts, basis.delays), facts)


def write_family(family: Family, count: int, seed: int, add: Callable[[Path], None] | None = None) -> Path:
    """Write a family of `count` members whole or not at all; its folder. `add` writes further files into it.

    Raises BadInput, and what `add` raises.
    """
    place = family.folder / "vary" / f"seed-{seed}"
    place.parent.mkdir(parents=True, exist_ok=True)
    with temp_folders.folder_beside(place) as partial:
        open_as_parent(partial)
        _write(family, count, seed, partial)
        if add:
            add(partial)
        shutil.rmtree(place, ignore_errors=True)
        partial.rename(place)
    return place


# ------------------------------------------------------------------ members
def members(family: Family, count: int, seed: int) -> tuple[list[tuple[dict[str, float], Script]], int]:
    """`count` members with their values, and the number of draws. Raises BadInput where too few draws are members."""
    rng = np.random.default_rng(seed)
    found: list[tuple[dict[str, float], Script]] = []
    drawn = 0
    while len(found) < count:
        drawn += 1
        values = family.values(rng.standard_normal(len(family.parameters)))
        if (made := member(family.basis, values)) is not None:
            found.append((values, made))
        elif drawn > TRIES * (len(found) + 5):
            raise BadInput(
                f"{family.folder}: of {drawn} draws only {len(found)} are the same crash; this case cannot be varied"
            )
    return found, drawn


def _write(family: Family, count: int, seed: int, place: Path) -> None:
    found, drawn = members(family, count, seed)
    (place / "concrete").mkdir()
    behavior = _conditions(family)
    for number, (values, made) in enumerate(found, 1):
        seen = behavior.model_copy(update={"light": light_of(values)}) if "light" in values else behavior
        text = write_xosc(made.actors, made.trajectories, seen, "../../../road.xodr", f"member {number}")
        (place / "concrete" / f"{number:04d}.xosc").write_text(text, encoding="utf-8")
    for name, text in files_of(family, [values for values, _ in found], seed).items():
        (place / f"{name}.xosc").write_text(text, encoding="utf-8")
    case_folder.write_json(place / "manifest.json", _manifest(family, found, drawn, seed))


def files_of(family: Family, sets: Sequence[Mapping[str, float]], seed: int) -> dict[str, str]:
    """The logical scenario, and the files that distribute its parameters: as listed, and as drawn."""
    ranges = [_range(p) for p in family.parameters]
    return {
        "logical": _logical(family, ranges, _conditions(family)),
        "deterministic": deterministic_distribution("logical.xosc", sets),
        "stochastic": stochastic_distribution("logical.xosc", ranges, len(sets), seed),
    }


def _conditions(family: Family) -> BehaviorSpec:
    """Light, weather and surface as read: the part of a behavior that a scenario file needs."""
    told = {f["field"].split(".")[1]: f["value"] for f in family.facts if f["field"].startswith("conditions.")}
    surface = told.get("surface") if told.get("surface") in SURFACES else None
    weather, light = told.get("weather"), told.get("light")
    return BehaviorSpec.model_construct(actors=(), contacts=(), light=light, weather=weather, surface=surface)


def _range(p: Parameter) -> ParameterRange:
    return ParameterRange(
        p.name, p.nominal, p.low, p.high, p.mean, p.spread if p.kind == "normal" else 0.0, p.values, p.shares
    )


def _logical(family: Family, ranges: Sequence[ParameterRange], behavior: BehaviorSpec) -> str:
    basis = family.basis
    nominal = undisturbed(basis, {p.name: p.nominal for p in family.parameters})
    shifted = max((float(np.abs(d.linear).max()) for d in basis.delays.values()), default=0.0) * LATER_S
    back = round((BACK * basis.contact_s + shifted) / 0.05) * 0.05
    lit = any(p.name == "light" for p in family.parameters)
    seen = behavior.model_copy(update={"light": LIGHTS[0]}) if lit else behavior
    text = write_xosc(nominal.actors, with_earlier_start(nominal, back), seen, "../../road.xodr", "logical")
    text = with_sun_parameter(text, "light", [SUNS[light] for light in LIGHTS]) if lit else text
    motions = [_meets(basis, t.actor, back) for t in nominal.trajectories]
    return logical_xosc(text, ranges, motions, basis.contact_s)


def _meets(basis: FamilyBasis, actor: str, back: float) -> ParameterizedActor:
    """Dependence of an actor's motion in the logical file on the parameters, as in `variant`."""
    who = basis.owner(actor)
    lanes = (f"{who}_lane_m", *((f"{PAIR}_lane_m",) if who in basis.coupled else ()))
    other, per_m = basis.crossed.get(who, ("", 0.0))
    delay = basis.delays.get(who)
    warp = TimeShift(f"{who}_reaction_s", delay.t_s + back, delay.linear, delay.square, delay.cube) if delay else None
    return ParameterizedActor(
        actor, basis.contact_s + back, lanes, ((f"{other}_lane_m", per_m),) if per_m else (), warp
    )


def _manifest(
    family: Family, found: Sequence[tuple[dict[str, float], Script]], drawn: int, seed: int
) -> dict[str, Any]:
    """Content of manifest.json: for every value whether it is a fact of the report, inferred, or varied."""
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
        "traffic_left_out": len(script.background),
        "not_varied": unvaried(script, family.facts, family.parameters),
    }  # fmt: skip


def _standing(fact: Mapping[str, Any]) -> str:
    return {"stated": "report fact", "inferred": "inferred"}.get(str(fact.get("status")), "default")
