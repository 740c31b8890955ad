"""One behind the other drives its way, whatever sides touch."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read


@pytest.mark.parametrize("text", [
    "The AV was at a complete stop on eastbound Oak Street. A delivery truck traveling behind and to the left of the "
    "AV proceeded forward. Shortly thereafter, the truck made contact with the AV, damaging the AV's front left side.",
    "The AV was traveling east and came to a stop behind a truck. While reversing, the truck made contact with the "
    "front of the AV.",
])  # fmt: skip
def test_one_behind_the_other_drives_its_way(text: str) -> None:
    assert [v.heading for v in read(text).crash.vehicles] == ["E", "E"]
