# ruff: noqa: E501 - lists of words
"""Words for numbers, lanes, roads, junctions, speeds and vehicle mentions, in the variants that reports use."""

from __future__ import annotations

import re
from random import Random

from mini.generator import clauses_road as more
from mini.generator.world import WORDS, Crash, Leg

OF_TWO = re.compile(
    r"\{W\}|\bboth (?!directions|ways|straight|hands|arms|front|facts|\{)|\beither(?! (?:way|side|direction))"
    r"|\bneither (?:driver|vehicle|of)|\beach other|other \[?(?:driver|vehicle|car|motorist)|\bthey\b"
    r"|\bthe two\b(?! lanes)|\b(?:two|the) \[?(?:two )?(?:vehicles|cars|drivers|motorists)\b|\bpileup",
    re.IGNORECASE,
)
"""Words that tell of a second vehicle."""


def of_one(clauses: list[str]) -> list[str]:
    """The clauses that speak of no second vehicle."""
    return [clause for clause in clauses if not OF_TWO.search(clause)]


NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
ORDINALS = ("", "first", "second", "third", "fourth", "fifth", "sixth")
SHORT_ORDINALS = ("", "1st", "2nd", "3rd", "4th", "5th", "6th")
MORE = 0.4
"""How often a phrase of `clauses_road` takes the place of one built here, where phrases are not held out."""

COUNTED = 0.25
"""Share of those who came by the only lane of whom it is said that it was the right or the first one."""


def direction(rng: Random, bearing: int, held_out: bool) -> str:
    """`north`, `in a northerly direction`, ..."""
    word = WORDS[bearing % 8]
    if not held_out and rng.random() < MORE / 2:
        return more.phrase(rng, more.DIRECTION, word=word)
    forms = [word] * 6 + [f"in a {word}erly direction", f"{word}bound"]
    if not held_out:
        forms += [f"in the {word} direction", f"to the {word}", f"in a {word}ward direction", f"due {word}"]
    return rng.choice([*forms, f"toward the {word}"] if held_out else forms)


def bound(rng: Random, bearing: int) -> str:
    """`northbound`; now and then `north bound` or N/B."""
    word = WORDS[bearing % 8]
    if len(word) > 5:
        return f"{word}bound"
    return rng.choices([f"{word}bound", f"{word} bound", f"{word[0].upper()}/B"], [94, 4, 2])[0]


def axis(rng: Random, bearing: int) -> str:
    """`north/south` for either end of a road."""
    low = bearing % 4
    pair = (WORDS[low], WORDS[low + 4])
    if low == 2:
        return rng.choice(("east/west", "east/west", "east-west", "east west", "west/east"))
    return rng.choice(("/", "/", "-", " ")).join(pair)


def kph(mph: int) -> int:
    """Kilometres an hour, as rounded in reports."""
    return round(mph * 1.609)


def limit(rng: Random, mph: int, held_out: bool) -> str:
    """A speed limit in one of the unit spellings; a wrong pair now and then."""
    k = kph(mph) if rng.random() > 0.015 else kph(mph + rng.choice((-5, 5)))
    if not held_out and rng.random() < MORE:
        return more.phrase(rng, more.LIMIT, mph=str(mph), kph=str(k))
    forms = (
        (f"{k} kmph ({mph} mph)", 24), (f"{k} KMPH ({mph} MPH)", 12), (f"{k}kmph ({mph}mph)", 10), (f"{mph} mph", 14), (f"{mph} MPH", 14),
        (f"{mph} MPH ({k} KPH)", 6), (f"{k} kph ({mph} mph)", 8), (f"{k}kph ({mph}mph)", 4), (f"{mph} mph ({k} kph)", 6),
        (f"{k} KPH ({mph} MPH)", 4), (f"{k} kpmh ({mph} mph)", 1),
    )  # fmt: skip
    return rng.choices([f for f, _ in forms], [w for _, w in forms])[0]


def driver_speed(rng: Random, mph: int) -> tuple[str, int]:
    """A driver's speed as told and the number to answer: ranges give their middle, rounded to fives up."""
    if rng.random() < 0.6:
        low = (max(mph, 1) - 1) // 10 * 10 + 1
        text = rng.choice((
            f"between {low}-{low + 9} MPH", f"{kph(low)}-{kph(low + 9)} kmph ({low}-{low + 9} mph)", f"{low}-{low + 9} mph",
            f"between {low} and {low + 9} mph",
        ))  # fmt: skip
        return text, low + 4
    text = rng.choice(
        (
            f"{mph} mph",
            f"about {mph} MPH",
            f"approximately {mph} mph",
            f"{kph(mph)} kmph ({mph} mph)",
            f"{kph(mph)}kmph ({mph}mph)",
            f"at {mph} MPH",
        )
    )
    return text, mph


def lanes(count: int, way: str = "") -> str:
    """`one lane`, `two northbound lanes`."""
    return f"{NUMBERS[count]} {way}{' ' * bool(way)}lane{'s' * (count > 1)}"


def lane(rng: Random, leg: Leg, number: int | None, xb: str, held_out: bool) -> tuple[str, bool]:
    """The lane's name: by side, number, direction or use; and whether only who knows the lanes beside it can number it,
    from the right as answers do."""
    if not held_out and leg.lanes_in == 1 and rng.random() < COUNTED:
        return rng.choice(
            ("first lane", "lane one", "lane 1", "right lane", f"right {xb} lane", "first travel lane")
        ), False
    if not held_out and rng.random() < MORE and (kind := _kind_of_lane(rng, leg, number)):
        name = more.phrase(rng, more.LANE[kind], xb=xb, number=NUMBERS[number or 1], ordinal=ORDINALS[number or 1])
        return name, kind in ("left", "turn_left")
    lanes, use = max(leg.lanes_in, 1), ""
    if leg.turns_in and number:
        use = leg.turns_in[number - 1]
    if use in ("left", "right") and rng.random() < 0.85:
        names = [
            f"{xb} {use}-turn lane",
            f"{use} turn lane",
            f"{use}-turn lane",
            f"{xb} {use} turn lane",
            f"dedicated {use} turn lane",
        ]
        return rng.choice(names), use == "left"
    through = sum("through" in u for u in leg.turns_in)
    if use == "through" and through == 1 and rng.random() < 0.4:
        return rng.choice((f"{xb} through-lane", "through lane", f"{xb} through lane")), True
    if lanes == 1 or number is None:
        return rng.choice((f"{xb} lane", f"{xb} lane", f"{xb} travel lane", "only lane")), False
    numbered = [
        f"lane {NUMBERS[number]}",
        f"{ORDINALS[number]} travel lane",
        f"{SHORT_ORDINALS[number]} travel lane",
        f"lane {number}",
        f"{ORDINALS[number]} lane",
    ]
    sided: list[str] = []
    if number == 1:
        sided = ["right lane", f"right {xb} lane", "right travel lane", "curb lane", "far right lane"] * 2
    elif number == lanes and use != "left":
        sided = ["left lane", f"left {xb} lane", "left travel lane", "passing lane", "inside lane"] * 2
    elif lanes == 3 and number == 2:
        sided = ["middle lane", "center lane", f"middle {xb} lane"] * 3
    name = rng.choice(numbered + sided)
    return name, number == lanes and name in sided


def _kind_of_lane(rng: Random, leg: Leg, number: int | None) -> str:
    """Which list of `clauses_road.LANE` names a lane; "" if none does."""
    use = leg.turns_in[number - 1] if leg.turns_in and number else ""
    if use in ("left", "right"):
        return f"turn_{use}"
    if leg.lanes_in == 1:
        return "only"
    if number is None or rng.random() < 0.2:
        return "numbered" if number else ""
    if number == 1 or number == leg.lanes_in:
        return "right" if number == 1 else "left"
    return "middle" if leg.lanes_in == 3 else "numbered"


def junction(rng: Random, crash: Crash, held_out: bool) -> str:
    """`a T-intersection`, `a four-leg intersection`, or the plain word."""
    if not held_out and rng.random() < MORE:
        return "a " + more.phrase(rng, more.JUNCTION[crash.layout])
    if crash.layout == "four":
        return "a " + rng.choice(
            (
                "four-leg intersection",
                "four-leg intersection",
                "four-way intersection",
                "4-way intersection",
                "four-legged intersection",
                "4-leg intersection",
                "four leg intersection",
                "4 way intersection",
                "4 leg intersection",
                "cross intersection",
                "crossing of two roads",
            )
        )
    return "a " + rng.choice(
        (
            "T-intersection",
            "T-intersection",
            "T-intersection",
            "T intersection",
            '"T" intersection',
            "'T' intersection",
            "\u201cT\u201d intersection",
            "t-intersection",
            "three-leg intersection",
            "three-way intersection",
            "three-legged intersection",
            "type T intersection",
            "3-leg intersection",
            "3-way intersection",
            "three leg intersection",
            "T-type intersection",
            "T-shaped intersection",
            "T junction",
        )
    )


def person(rng: Random) -> dict[str, str]:
    """Age, sex and pronouns of an occupant."""
    age, male = rng.randint(16, 88), rng.random() < 0.5
    form = rng.choice(("{}-year-old", "{}-year-old", "{}-year old", "{} year old"))
    return {
        "age": form.format(age), "sex": "male" if male else "female", "He": "He" if male else "She",
        "he": "he" if male else "she", "his": "his" if male else "her", "His": "His" if male else "Her",
    }  # fmt: skip
