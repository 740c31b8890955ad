"""Which contacts come before a rollover, by the order of the telling."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

START = "V1 was traveling north on a two lane road and departed the road to the right. "


@pytest.mark.parametrize(("told", "before"), [
    ("The front of V1 struck a sign. The right side of V1 then struck a tree. V1 then rolled over onto its roof.", 2),
    ("The front of V1 struck a sign. V1 then rolled over onto its roof. The top of V1 struck a tree.", 1),
    ("The front of V1 struck a sign and then a curb causing it to roll over two quarter turns to the left.", 2),
    ("The front of V1 struck a sign. The right front of V1 struck a culvert causing it to roll over to the left.", 2),
    ("V1 rolled over onto its roof.", 1),
])  # fmt: skip
def test_contacts_that_are_told_before_the_roll_are_behind_it(told, before) -> None:
    course = read(START + told).crash.courses["V1"]
    assert course.rolls
    assert course.rolls_after == before
