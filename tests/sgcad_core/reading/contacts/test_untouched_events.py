"""A lone vehicle that touches nothing has a crash all the same, where the text tells what happens to it."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

START = "V1 was eastbound on a two-lane road. "


@pytest.mark.parametrize(
    ("words", "kind"),
    [("V1 departed the roadway to the right and rolled two quarter turns.", "rollover"),
     ("V1 caught fire and stopped on the shoulder.", "fire"),
     ("V1 braked on the ice and jackknifed.", "jackknife"),
     ("V1 went off the road and into a small creek.", "water"),
     ("V1 departed the roadway to the left and came to rest in a field.", "departure")],
)  # fmt: skip
def test_the_event_stands_for_the_contact(words: str, kind: str) -> None:
    crash = read(START + words).crash
    assert crash.untouched is not None
    assert (crash.untouched.vehicle, crash.untouched.kind, crash.gap, crash.contacts) == ("V1", kind, None, ())


@pytest.mark.parametrize("words", ["V1 overturned when it struck a tree.", "V1 was parked in a lot."])
def test_no_event_beside_a_contact_or_without_words(words: str) -> None:
    assert read(START + words).crash.untouched is None


def test_the_order_of_things_and_vehicles_is_that_of_the_text() -> None:
    text = "V1 and V2 were eastbound. V1 struck a sign. The front of V1 struck the rear of V2. V2 then struck a pole."
    assert [(i.actor, i.other, i.after) for i in read(text).crash.impacts] == [("V1", "sign", 0), ("V2", "pole", 1)]
