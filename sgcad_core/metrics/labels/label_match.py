"""A result against the ground truth of its case: every field that the label states, as 1 right, 0 wrong or an error.

Labels are the dictionaries of truth/<case>.json. Statements of the run are not used: lanes and junctions are counted in
its network, contacts found in its motion (`motion_label_match`). A case without output is wrong. Road errors follow the
paper's formula (mean over reports) and count any error (share of reports; the published tables appear to be this one).
Knows no file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sgcad_core.kinds import FOUR_LEG
from sgcad_core.metrics.labels.motion_label_match import Path, motion_marks
from sgcad_core.roads.lane_graph import RoadCounts, road_counts

NETWORK_FIELDS = (
    "intersection_count_error", "lane_count_error", "segment_count_error", "segment_lanes_error", "connectivity_error",
)  # fmt: skip
"""Errors; each also stands as `<name>_any`, 1 where there is any."""
_LEGS = {"t": 3, FOUR_LEG: 4}

Label = Mapping[str, Any]


class GeneratedCase(NamedTuple):
    """Output of a generated case: road counts, and the paths of its actors (empty without an execution)."""

    roads: RoadCounts
    paths: Mapping[str, Path]


class TruthFigures(NamedTuple):
    """Network figures of a label; None where it states none."""

    intersections: int | None
    components: int | None
    mean_lanes: float | None


def compare(label: Label, made: GeneratedCase | None) -> dict[str, float]:
    """field -> 1.0 right, 0.0 wrong, a share right, or an error in [0, 1]; fields left open are absent.

    `made` is None for a case that was refused, exhausted, failed or cannot be read.
    """
    roads = made.roads if made else None
    return {
        **_network_errors(label, roads),
        **_coded_roads(label, roads),
        **motion_marks(label, made.paths if made else {}),
    }


def truth_figures(label: Label) -> TruthFigures:
    """Counts of a label; mean lanes come from its segments, contracted as a made network's are."""
    return _figures(label, _truth_counts(label))


def _figures(label: Label, counts: RoadCounts | None) -> TruthFigures:
    network = label["network"]
    mean = counts.figures.mean_lanes if counts else None
    return TruthFigures(network.get("intersections"), network.get("components"), mean)


def _truth_counts(label: Label) -> RoadCounts | None:
    """Counts of a label's segments, contracted; None where it has none."""
    lanes = truth_lanes(label)
    return road_counts(lanes) if lanes else None


def truth_lanes(label: Label) -> dict[tuple[str, str], int]:
    """Lanes by (from, to) node of a label's segments; empty where it has none."""
    found: dict[tuple[str, str], int] = {}
    for segment in label["network"].get("segments") or ():
        there, back = (segment["from"], segment["to"]), (segment["to"], segment["from"])
        for ends, lanes in ((there, segment.get("lanes_towards_to")), (back, segment.get("lanes_towards_from"))):
            if lanes:
                found[ends] = found.get(ends, 0) + lanes
    return found


def relative_error(truth: float, made: float) -> float:
    """1 - max(0, 1 - |truth - made| / truth), in [0, 1]; a truth of 0 is divided by 1 (the paper leaves 0/0 open)."""
    return min(1.0, abs(truth - made) / (truth or 1.0))


def any_error(error: float) -> float:
    """1 if a report has any error, else 0: its mean over reports is the share with an error."""
    return float(error > 1e-6)


def _network_errors(label: Label, roads: RoadCounts | None) -> dict[str, float]:
    found: dict[str, float] = {}
    counts = _truth_counts(label)
    truth = _figures(label, counts)
    made = roads.figures if roads else None
    if truth.intersections is not None:
        error = relative_error(truth.intersections, made.intersections) if made else 1.0
        found["intersection_count_error"] = error
    if truth.mean_lanes:
        found["lane_count_error"] = relative_error(truth.mean_lanes, made.mean_lanes) if made else 1.0
    found |= _segment_errors(counts.chains if counts else (), roads)
    if truth.components:
        found["connectivity_error"] = float(made is None or made.components != truth.components)
    return found | {f"{name}_any": any_error(error) for name, error in found.items()}


def _segment_errors(truth: Sequence[tuple[int, int]], roads: RoadCounts | None) -> dict[str, float]:
    """The other half of the lane count error: how many segments, and where that is right, the lanes of each.

    Segments have no names in common, so each of the truth has to find one of its own with the same lanes, whichever
    way it runs: the error is the share that finds none. The paper gives no formula for it.
    """
    if not truth:
        return {}
    if roads is None:
        return {"segment_count_error": 1.0, "segment_lanes_error": 1.0}
    found = {"segment_count_error": relative_error(len(truth), len(roads.chains))}
    if len(truth) == len(roads.chains):
        wanted, made = (Counter(tuple(sorted(both)) for both in chains) for chains in (truth, roads.chains))
        found["segment_lanes_error"] = 1.0 - (wanted & made).total() / len(truth)
    return found


def _coded_roads(label: Label, roads: RoadCounts | None) -> dict[str, float]:
    """Lane totals of the trafficways named (with or without a two-way left-turn lane), and the number of legs."""
    found: dict[str, float] = {}
    coded = [road for road in label["network"].get("roads", ()) if road.get("lanes_total")]
    if coded:
        found["lanes_total"] = sum(_total_right(road, roads) for road in coded) / len(coded)
    if legs := _LEGS.get(label["network"].get("layout_best") or ""):
        found["legs"] = float(roads is not None and roads.max_degree == legs)
    return found


def _total_right(road: Mapping[str, Any], roads: RoadCounts | None) -> bool:
    chains = roads.chains if roads else ()
    undivided = road.get("lanes_scope") == "both_directions"
    counted = {sum(both) for both in chains} if undivided else {n for both in chains for n in both if n}
    return bool({road["lanes_total"], road["lanes_total"] - bool(road.get("twltl"))} & counted)
