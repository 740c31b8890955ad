"""What goes beyond a limit is told and not silently changed."""

import pytest

from sgcad_core.reading.inference.reading_limits import limit_notes
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import MOST_READ

TEXT = "V1 was traveling north on a two-lane road at {speed}. V2 was stopped. The front of V1 struck the back of V2."


@pytest.mark.parametrize("speed", ["200 mph", "900 mph", "400 kmph"])
def test_a_speed_that_nobody_drives_is_told(speed):
    reading = read(TEXT.format(speed=speed))
    assert reading.crash.vehicles[0].speed_mph == 120
    (note,) = limit_notes(reading)
    assert note == f"limit: {speed!r} is told; 120 mph, the most that is driven, stands in"


@pytest.mark.parametrize("speed", ["45 mph", "100 mph", "an unknown speed"])
def test_an_ordinary_speed_is_not(speed):
    assert list(limit_notes(read(TEXT.format(speed=speed)))) == []


def test_a_text_that_is_cut_is_told():
    text = TEXT.format(speed="45 mph") + " The road was dry." * 1000
    (note,) = limit_notes(read(text))
    assert note.startswith(f"limit: the rules read the first 16,000 of {len(text):,} characters")
    assert MOST_READ == 16_000
