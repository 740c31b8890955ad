"""Measures of tables: name, unit, direction and key in a case's values.

A case's values are one flat mapping (`values_of`); values that do not exist for a case are absent and not in n.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal, NamedTuple

from flows.results.reading import FinishedCase, Study, made_of
from sgcad_core.metrics.generation import quality, written_files
from sgcad_core.metrics.labels.label_match import NETWORK_FIELDS, compare
from sgcad_core.result import STATUSES, as_declared, counts_of

Kind = Literal["share", "mean", "ratio"]
Better = Literal["low", "high", ""]
SHORT = {
    "intersection_count_error": "intersections", "lane_count_error": "lanes", "segment_count_error": "segments",
    "segment_lanes_error": "segment_lanes", "connectivity_error": "connectivity",
}  # fmt: skip


class Measure(NamedTuple):
    """One figure of a table.

    kind: `share` of cases (0/1 values, printed in percent), `mean` of values, `ratio` of two sums (percent).
    key: the case value, of a ratio numerator and denominator. better: which direction is better, if either.
    """

    name: str
    label: str
    kind: Kind = "share"
    unit: str = "%"
    better: Better = ""
    keys: tuple[str, ...] = ()
    digits: int = 1

    @property
    def key(self) -> str:
        """Name of a case's value."""
        return self.keys[0] if self.keys else self.name

    @property
    def factor(self) -> float:
        """Factor from a fraction to the printed value."""
        return 100.0 if self.unit == "%" else 1.0


def _wrong(name: str, label: str) -> Measure:
    return Measure(name, label, better="low")


def _right(name: str, label: str, kind: Kind = "mean") -> Measure:
    return Measure(name, label, kind, better="high")


GENERATION = (
    _right("generated", "GSR", "share"),
    Measure("refused", "refused"),
    _wrong("exhausted", "exhausted"),
    _wrong("failed", "failed"),
    Measure("file_errors", "AER", "ratio", better="low", keys=("files_faulty", "files_written")),
    _right("first_success", "GSR at first", "share"),
    Measure("attempts", "attempts", "mean", "", "low"),
    _right("as_declared", "crash as declared", "share"),
    _right("account_whole", "all told", "share"),
    Measure("account_kept", "of told", "ratio", better="high", keys=("account_has", "account_told")),
    Measure("account_assumed", "assumed", "mean", "", "low"),
)
NETWORK_WRONG = (
    _wrong("intersections_wrong", "ICE"), _wrong("lanes_wrong", "LCE"), _wrong("connectivity_wrong", "CE"),
)  # fmt: skip
NETWORK_MEAN = tuple(
    Measure(f"{short}_error", label, "mean", "%", "low")
    for short, label in zip(SHORT.values(), ("ICE", "LCE", "segments", "lanes a segment", "CE"), strict=True)
)
PEOPLE = (
    Measure("person_facts", "facts by people", "mean", "", digits=2),
    Measure("person_disagreed", "read otherwise", "ratio", better="low", keys=("person_disagreed", "person_given")),
)
TRUTH = (
    _right("lanes_total", "lanes total"),
    _right("legs", "legs", "share"),
    _right("vehicle_count", "vehicles", "share"),
    _right("initial_heading", "initial heading"),
    _right("relative_heading", "relative heading", "share"),
    _right("maneuver", "maneuver"),
    _right("collision_pair", "first contact: pair", "share"),
    _right("collision_areas", "pair and sides", "share"),
)
PAPER = (
    Measure("p_collision_any", "P_c > 0", better="high"),
    Measure("p_collision", "mean P_c", "mean", "", "high", digits=3),
    Measure("p_near_miss_any", "near miss", better="high"),
    Measure("p_distance", "min distance", "mean", "m", "low", digits=2),
    Measure("p_ttc", "TTC", "mean", "s", "low", digits=2),
    Measure("p_pet", "PET", "mean", "s", "low", digits=2),
    Measure("p_intensity", "intensity", "mean", "1/m", "high", digits=2),
    Measure("p_ade", "ADE", "mean", "m", digits=2),
    Measure("p_fde", "FDE", "mean", "m", digits=2),
)
PAPER_RISK = tuple(
    Measure(f"p_{level}", label) for level, label in (
        ("critical", "critical"), ("high", "high"), ("moderate_low", "moderate and low"),
    )
)  # fmt: skip
EXACT = (
    _right("x_collision", "collision", "share"),
    Measure("x_speed", "impact speed", "mean", "m/s", digits=2),
    Measure("x_distance", "min distance", "mean", "m", "low", digits=2),
    Measure("x_ttc", "TTC", "mean", "s", "low", digits=2),
    Measure("x_pet", "PET", "mean", "s", "low", digits=2),
    Measure("x_ade", "ADE", "mean", "m", digits=2),
    Measure("x_fde", "FDE", "mean", "m", digits=2),
    *(Measure(f"x_{level}", label) for level, label in (
        ("critical", "critical"), ("high", "high"), ("moderate_low", "moderate and low"),
    )),
)  # fmt: skip
CONFLICT = (
    Measure("c_ttc", "TTC-1s", "mean", "s", digits=2),
    Measure("c_drac", "DRAC-1s", "mean", "m/s2", digits=2),
    Measure("c_exposed", "exposed", "mean", "s", digits=2),
    Measure("c_closing", "closing", "mean", "m/s", digits=1),
    Measure("c_delta_v", "delta-v", "mean", "m/s", digits=1),
    Measure("c_risk", "death", "mean", "%", digits=1),
    Measure("c_brake", "brake by", "mean", "s", digits=2),
    Measure("c_steer", "steer by", "mean", "s", digits=2),
)
DRIVEN = tuple(
    measure
    for role, short in (("initiator", "init."), ("responder", "resp."))
    for measure in (
        Measure(f"d_{role}_avoided", f"{short} avoided", better="high"),
        Measure(f"d_{role}_mitigated", f"{short} mitigated"),
        Measure(f"d_{role}_worse", f"{short} worse", better="low"),
        Measure(f"d_{role}_lost", f"{short} lost"),
    )
)
ROBUSTNESS = (
    _right("generated", "GSR", "share"),
    Measure("refused", "refused"),
    _wrong("made_intersections_wrong", "ICE of generated"),
    _wrong("made_lanes_wrong", "LCE of generated"),
)

_PAPER = {
    "p_collision": "collision_probability", "p_distance": "minimum_distance_m", "p_ttc": "time_to_collision_s",
    "p_pet": "post_encroachment_time_s", "p_intensity": "interaction_intensity_mean",
    "p_ade": "average_displacement_error_m", "p_fde": "final_displacement_error_m",
}  # fmt: skip
_EXACT = {
    "x_collision": "collision", "x_speed": "collision_speed_mps", "x_distance": "minimum_distance_m",
    "x_ttc": "time_to_collision_s", "x_pet": "post_encroachment_time_s", "x_ade": "average_displacement_error_m",
    "x_fde": "final_displacement_error_m",
}  # fmt: skip
_CONFLICT = {
    "c_ttc": "ttc_1_s_before_s", "c_drac": "drac_1_s_before_mps2", "c_exposed": "time_exposed_ttc_s",
    "c_closing": "collision_speed_mps", "c_delta_v": "delta_v_worst_mps", "c_risk": "fatality_risk",
    "c_brake": "brake_by_s", "c_steer": "steer_by_s",
}  # fmt: skip


def values_of(ran: FinishedCase, label: Mapping[str, Any] | None) -> dict[str, float]:
    """All values of a finished case, as fractions and in SI units."""
    found = dict(_generation(ran))
    found |= dict(_people(ran.result.get("person") or {}))
    if label is not None:
        found |= _truth(compare(label, made_of(ran.folder, ran.result)), ran.generated)
    if ran.generated:
        found |= dict(_reading(ran.metrics.get("paper", {}), _PAPER, "p"))
        found |= dict(_reading(ran.metrics.get("exact", {}), _EXACT, "x"))
        found |= dict(_conflict(ran.metrics.get("exact", {})))
        found |= dict(_driven(ran.metrics.get("drive") or {}))
    return found


def study_values(study: Study) -> dict[str, dict[str, dict[str, float]]]:
    """arm -> case -> values."""
    return {
        arm: {case: values_of(ran, study.labels.get(case)) for case, ran in cases.items()}
        for arm, cases in study.ran.items()
    }


def _generation(ran: FinishedCase) -> Iterator[tuple[str, float]]:
    yield from ((status, float(ran.result["status"] == status)) for status in STATUSES)
    seen = ran.seen()
    counts = written_files(seen)
    yield "files_written", float(counts.written)
    yield "files_faulty", float(counts.faulty)
    yield "attempts", float(len(seen.attempts))
    yield "first_success", quality([seen]).first_success
    if (hit := as_declared(ran.result)) is not None:
        yield "as_declared", float(hit)
    if account := counts_of(ran.result):
        yield "account_whole", float(account["verdict"] == "whole")
        yield from ((f"account_{name}", float(account[name])) for name in ("told", "has", "assumed"))


def _people(said: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Facts that people gave, and those that were read otherwise; nothing of a case without such facts."""
    if said.get("facts"):
        yield from (("person_facts", float(said["facts"])), ("person_given", float(said["facts"])))
        yield "person_disagreed", float(said["disagreed"])


def _truth(marks: Mapping[str, float], generated: bool) -> dict[str, float]:
    """The comparison under the names of measures: `lanes_error`, `lanes_wrong`, and `made_lanes_wrong` if generated."""
    found = {k: v for k, v in marks.items() if not k.startswith(NETWORK_FIELDS)}
    for field, short in SHORT.items():
        if field in marks:
            found |= {f"{short}_error": marks[field], f"{short}_wrong": marks[f"{field}_any"]}
            if generated:
                found[f"made_{short}_wrong"] = marks[f"{field}_any"]
    return found


def _conflict(figures: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Figures of the conflict; of a figure by actor that of the actor that had to act first."""
    for name, key in _CONFLICT.items():
        value = figures.get(key)
        if isinstance(value, Mapping):
            value = max((v for v in value.values() if v is not None), default=None)
        if value is not None:
            yield name, float(value)


def _driven(drivers: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Outcomes by role, of an arm with one driver; drives that failed are left out."""
    for role, figures in next(iter(drivers.values())).items() if len(drivers) == 1 else ():
        if not figures.get("failed"):
            yield from ((f"d_{role}_{k}", float(figures[k])) for k in ("avoided", "mitigated", "worse", "lost"))


def _reading(figures: Mapping[str, Any], names: Mapping[str, str], prefix: str) -> Iterator[tuple[str, float]]:
    """One reading of metrics.json; null values stay out."""
    for name, key in names.items():
        if figures.get(key) is not None:
            yield name, float(figures[key])
    for name, key in (("p_collision_any", "collision_probability"), ("p_near_miss_any", "near_miss_probability")):
        if prefix == "p" and figures.get(key) is not None:
            yield name, float(figures[key] > 0)
    if level := figures.get("emergency_level"):
        level = level if level in ("critical", "high") else "moderate_low"
        yield from ((f"{prefix}_{k}", float(k == level)) for k in ("critical", "high", "moderate_low"))
