"""How a vehicle comes to the stop at which it is struck."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read
from sgcad_core.records.course import CourseTold

_STRUCK = "A taxi then struck the rear of the van."


@pytest.mark.parametrize(("told", "comes"), [
    ("The van was traveling north and slowed to a stop at a red light.", "drives_up"),
    ("The van stopped for a stop sign.", "drives_up"),
    ("The van was stopped at a red light.", None),
    ("The van was traveling north and slowed. The van was stopped at a red light.", "drives_up"),
    ("The van was stopped at a stop sign, moved forward and then stopped to yield to cross traffic.", "moves_up"),
    ("The van was stopped, waiting to turn right, moved forward and then stopped to yield.", "moves_up"),
    ("The van stopped for a stop sign and then proceeded through the intersection.", None),
])  # fmt: skip
def test_a_stop_is_come_to_where_it_is_told_so(told: str, comes: str | None) -> None:
    found = read(f"{told} {_STRUCK}").crash
    assert found.driven.get("V1", CourseTold()).comes == comes


def test_numbered_vehicles_stand_as_they_are_struck() -> None:
    found = read("V1 was northbound and slowed to a stop at a red light. The front of V2 struck the back of V1.").crash
    assert found.driven.get("V1", CourseTold()).comes is None


@pytest.mark.parametrize(("told", "comes"), [
    ("As the light turned green and V1 began to move,", "moves_off"),
    ("V1 waited to turn left. Then", None),
])  # fmt: skip
def test_one_that_stood_and_has_begun_to_move_moves_off(told, comes) -> None:
    stood, struck = "V1 was stopped at a red light ahead of V2.", "the front of V2 struck the back of V1."
    found = read(f"V1 and V2 were northbound. {stood} {told} {struck}").crash
    assert found.driven.get("V1", CourseTold()).comes == comes
