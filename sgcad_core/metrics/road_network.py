"""Road-network errors against a ground truth: counts in, fractions out.

Two figures each: the error of the paper's formula (mean over reports) and whether there is any error
(share of reports; the published tables appear to be this one). Knows no file format.
"""

from __future__ import annotations

from typing import NamedTuple


class NetworkFigures(NamedTuple):
    """What is counted in a network: nodes of degree >= 3, connected parts, mean lanes a direction."""

    intersections: int
    components: int
    mean_lanes: float


def relative_error(truth: float, made: float) -> float:
    """1 - max(0, 1 - |truth - made| / truth), in [0, 1]; a truth of 0 is divided by 1 (the paper leaves 0/0 open)."""
    return min(1.0, abs(truth - made) / (truth or 1.0))


def intersection_count_error(truth: NetworkFigures, made: NetworkFigures) -> float:
    """ICE of the paper, a fraction."""
    return relative_error(truth.intersections, made.intersections)


def lane_count_error(truth: NetworkFigures, made: NetworkFigures) -> float:
    """LCE of the paper on the mean number of lanes a direction, a fraction."""
    return relative_error(truth.mean_lanes, made.mean_lanes)


def connectivity_error(truth: NetworkFigures, made: NetworkFigures) -> float:
    """CE of the paper: 0 where the number of connected parts is right, else 1 ("this binary metric")."""
    return float(truth.components != made.components)


def any_error(error: float) -> float:
    """1 if a report has any error, else 0: its mean over reports is the share with an error."""
    return float(error > 1e-6)


def network_errors(truth: NetworkFigures, made: NetworkFigures) -> dict[str, float]:
    """Both readings of the three errors under the names that results use."""
    formula = {
        "intersection_count_error": intersection_count_error(truth, made),
        "lane_count_error": lane_count_error(truth, made),
        "connectivity_error": connectivity_error(truth, made),
    }
    return formula | {f"{name}_any": any_error(value) for name, value in formula.items()}
