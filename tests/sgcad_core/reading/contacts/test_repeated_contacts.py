"""Two vehicles that touch once more, whether or not they are those of the first contact."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

BEGINS = "V1 was eastbound. V2 was northbound. V3 was southbound. The front of V1 struck the left side of V2. "


def _impacts(text: str) -> list[tuple[str, str, str | None, str | None, int]]:
    return [(i.actor, i.other, i.actor_area, i.other_area, i.after) for i in read(BEGINS + text).crash.impacts]


def test_a_pair_behind_the_first_one_may_touch_once_more() -> None:
    text = "The front of V2 then struck the front of V3. V2 turned on, and the left plane of V2 struck the left of V3."
    assert _impacts(text) == [("V2", "V3", "left", "left", 2)]


@pytest.mark.parametrize("between", ["", "V1 slid on. V2 turned. V3 stopped. "])
def test_sides_that_the_first_contact_had_not_tell_a_further_one(between: str) -> None:
    assert _impacts(between + "The right side of V1 struck the back of V2.")[0][:4] == ("V1", "V2", "right", "back")


def test_what_a_later_paragraph_tells_again_is_the_same_contact() -> None:
    assert _impacts("V1 slid on. V2 turned. V3 stopped.\n\nThe back of V1 struck the right side of V2.") == []
