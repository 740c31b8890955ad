"""Of all combinations of two actors' options the least odd one is taken, whatever their ranks in the lists."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from sgcad_core.planner.encounter import pairing
from sgcad_core.planner.encounter.pairing import Stage, part_of, search
from sgcad_core.records.course import CourseTold


@dataclass(frozen=True)
class Way:
    """A stand-in for an option: all that the search asks is its cost."""

    name: str
    cost: float


@pytest.mark.parametrize(("side", "corner", "part"), [
    ("front", ("front", "left"), "left"), ("left", ("front", "left"), "front"), ("right", ("back", "right"), "back"),
    ("back", ("front", "left"), None), ("front", None, None), (None, ("front", "left"), None),
])  # fmt: skip
def test_a_told_corner_is_met_at_its_part_of_the_side(side: str | None, corner: object, part: str | None) -> None:
    role = SimpleNamespace(side=side, told=CourseTold(corner=corner))  # type: ignore[arg-type]
    assert part_of(role) == part  # type: ignore[arg-type]


def test_a_dear_pair_is_not_taken_because_its_meeting_is_cheap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pairing, "_meeting", lambda a, b, wanted: SimpleNamespace(cost=0.1))
    first, second = [Way("plain", 0.0), Way("swerves", 1.6)], [Way("far off", 1.4), Way("near", 0.0)]
    found = search([Stage((first, second), 10)], None)  # type: ignore[arg-type]
    assert found is not None
    assert (found.first, found.second) == (first[0], second[1])
