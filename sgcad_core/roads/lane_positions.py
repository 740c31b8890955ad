"""Where a lane lies among those of its edge, and where it leads. Knows lane graphs; no motion and no report."""

from __future__ import annotations

from typing import NamedTuple

from sgcad_core.roads.lane_graph import Edge, Lane, LaneGraph, edge_of

_THROUGH = "through"


class Position(NamedTuple):
    """A lane of an edge: its place from the right curb, of how many, and the ways that lead out of it."""

    place: int
    lanes: int
    leads: frozenset[str]
    all_lead: frozenset[str]
    """The ways that lead out of any lane of the edge."""
    first_through: int
    """The rightmost lane that leads straight on; 1 where none does."""
    last_through: int


def position(graph: LaneGraph, lane: str, side: int = 0) -> Position | None:
    """Where a lane for cars, or the one on some side of it (1: left), lies among those of its edge; None for others."""
    edge = graph.edges.get(edge_of(lane))
    lanes = edge.laid_lanes if edge else ()
    place = next((i + side for i, other in enumerate(lanes, 1) if other.id == lane), None)
    if edge is None or place is None or not 1 <= place <= len(lanes):
        return None
    leads = [_leads(graph, edge, other) for other in lanes]
    through = [i for i, ways in enumerate(leads, 1) if _THROUGH in ways] or [1, len(lanes)]
    return Position(place, len(lanes), leads[place - 1], frozenset().union(*leads), through[0], through[-1])


def _leads(graph: LaneGraph, edge: Edge, lane: Lane) -> frozenset[str]:
    return frozenset(c.direction for c in graph.leaving(edge.id, lane.index))
