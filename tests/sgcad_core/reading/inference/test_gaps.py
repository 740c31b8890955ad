"""A text that tells too little of who met whom is refused; it is never filled with a made-up crash."""

import pytest

from sgcad_core.reading.reading import read

TOWED = (
    "V1 was a sedan. V2 was a pickup. It was daylight and the road was dry. Both vehicles were towed after the crash."
)


@pytest.mark.parametrize(
    "text",
    [
        TOWED,
        "The crash involved V1 and V2. V1 rotated clockwise and came to rest. V2 was driven from the scene.",
        "V2 had its lights on. The driver of V1 had failed to clear the frost from the windshield before the crash.",
    ],
)
def test_neither_contact_nor_direction_is_refused_with_what_is_missing(text: str) -> None:
    gap = read(text).crash.gap
    assert gap is not None
    assert gap.reason == "the narrative tells neither who struck whom nor how anybody traveled"
    assert gap.missing == ("who struck whom, and with which sides", "in which direction each traveled")
    assert gap.unread, "another reader may know more"


@pytest.mark.parametrize(
    "more",
    [
        " V1 struck V2.",
        " V1 was traveling north.",
        " The front of V1 contacted the back of V2.",
    ],
)
def test_one_told_contact_or_direction_is_enough(more: str) -> None:
    assert read(TOWED + more).crash.gap is None


def test_without_a_word_of_a_crash_that_is_the_reason() -> None:
    gap = read("V1 was a sedan. V2 was a pickup. It was daylight.").crash.gap
    assert gap is not None
    assert gap.reason == "the narrative tells no crash"


def test_who_crashes_alone_needs_no_direction() -> None:
    assert read("V1 ran off the road and struck a tree with its front.").crash.gap is None


@pytest.mark.parametrize(
    "text",
    [
        "V1, Audi p/u: NB on Oak fr S, turning L to go W on Elm. V2, Kia: SB on Oak fr N. V1 & V2 crash. Dry. "
        "V2 drvr sts no inj, V1 drvr cited.",
        "Insd = V1, Jeep. EB on Mill Rd fr W, stopped for traf. V2 hit V1, front to back. Wx clear, rd wet.",
    ],
)
def test_a_note_full_of_short_hand_is_english(text: str) -> None:
    assert read(text).crash.gap is None


@pytest.mark.parametrize(
    "text",
    [
        "V1 viajaba rumbo norte carril derecho. V2 viajaba rumbo sur. V2 gir\u00f3 izquierda. V1 choc\u00f3 V2. "
        "Pavimento seco, noche oscura, V1 V2 da\u00f1ados frente.",
        "V1 fuhr auf der Hauptstrasse nach Norden, als V2 von links kam und V1 mit der Front traf.",
        "V1 Nordfahrt rechter Fahrstreifen. V2 Gegenrichtung, bog links ab. Zusammenstoss V1 V2 frontal. Strasse nass, "
        "Nacht. V1 V2 Totalschaden, Fahrer verletzt.",
        "V1 roulait vers le nord sur la rue Principale quand V2 a tourne a gauche et a heurte V1. Elle etait seche.",
    ],
)
def test_other_languages_are_refused_though_they_number_vehicles(text: str) -> None:
    gap = read(text).crash.gap
    assert gap is not None
    assert gap.reason == "the narrative is not in English"
