"""Words for numbers, lanes, roads, junctions, speeds and vehicle mentions, in the variants that reports use."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

from research.generator.clauses import clause_words, road_clauses
from research.generator.crash.world import WORDS, Crash, Leg
from research.generator.grammar import clause_of
from research.generator.phrase_labels import plain
from research.generator.records import Group, slots_of
from sgcad_core.kinds import FOUR, T
from sgcad_core.reading.language import values

NUMBERS = ("zero", *values("number_word"), "eleven", "twelve")
_ORDINALS = sorted(values("ordinal"), key=values("ordinal").__getitem__)
ORDINALS = ("", *(word for word in _ORDINALS if word.isalpha()))
SHORT_ORDINALS = ("", *(word for word in _ORDINALS if not word.isalpha()))
MORE = 0.4
"""How often a phrase of `road_clauses` takes the place of one built here, where phrases are not held out."""

COUNTED = 0.25
"""Share of those who came by the only lane of whom it is said that it was the right or the first one."""


def direction(rng: Random, bearing: int, held_out: bool) -> str:
    """`north`, `in a northerly direction`, ..."""
    word = WORDS[bearing % 8]
    if not held_out and rng.random() < MORE / 2:
        return plain(road_clauses.phrase(rng, road_clauses.DIRECTION, word=word))
    return _one(rng, clause_words.DIRECTION["held_out" if held_out else "trained"]).format(word=word)


def bound(rng: Random, bearing: int) -> str:
    """`northbound`; now and then `north bound` or N/B."""
    word = WORDS[bearing % 8]
    if len(word) > 5:
        return f"{word}bound"
    return clause_words.BOUND.drawn(rng).format(word=word, initial=word[0].upper())


def axis(rng: Random, bearing: int) -> str:
    """`north/south` for either end of a road."""
    low = bearing % 4
    return _one(rng, clause_words.AXIS["east" if low == 2 else "other"]).format(one=WORDS[low], other=WORDS[low + 4])


def _one(rng: Random, options: Group) -> str:
    """A phrase without choices, of either side of the split."""
    return rng.choice(options.side(False))


def kph(mph: int) -> int:
    """Kilometres an hour, as rounded in reports."""
    return round(mph * 1.609)


def limit(rng: Random, mph: int, held_out: bool) -> str:
    """A speed limit in one of the unit spellings; a wrong pair now and then."""
    k = kph(mph) if rng.random() > 0.015 else kph(mph + rng.choice((-5, 5)))
    if not held_out and rng.random() < MORE:
        return plain(road_clauses.phrase(rng, road_clauses.LIMIT, mph=str(mph), kph=str(k)))
    return clause_words.LIMIT.drawn(rng).format(mph=mph, k=k)


def driver_speed(rng: Random, mph: int) -> tuple[str, int]:
    """A driver's speed as told and the number to answer: ranges give their middle, rounded to fives up."""
    if rng.random() < 0.6:
        low = (max(mph, 1) - 1) // 10 * 10 + 1
        text = _one(rng, clause_words.SPEED["between"])
        return text.format(low=low, high=low + 9, klow=kph(low), khigh=kph(low + 9)), low + 4
    return _one(rng, clause_words.SPEED["plain"]).format(mph=mph, k=kph(mph)), mph


def lanes(count: int, way: str = "") -> str:
    """`one lane`, `two northbound lanes`."""
    return f"{NUMBERS[count]} {way}{' ' * bool(way)}lane{'s' * (count > 1)}"


@dataclass(frozen=True)
class LaneName:
    """How a lane is named: the words, whether they say its direction (`headed`), and whether its number from the
    right, which answers want, follows only from the lanes beside it (`from_left`)."""

    text: str
    headed: bool
    from_left: bool = False


def lane(rng: Random, leg: Leg, number: int | None, xb: str, held_out: bool) -> LaneName:
    """The lane's name: by side, number, direction or use."""
    if not held_out and leg.lanes_in == 1 and rng.random() < COUNTED:
        return _named(_one(rng, clause_words.LANE["only"]), xb)
    if not held_out and rng.random() < MORE and (kind := _kind_of_lane(rng, leg, number)):
        clause = clause_of(rng, road_clauses.LANE[kind], False)
        slots = {"xb": xb, "number": NUMBERS[number or 1], "ordinal": ORDINALS[number or 1]}
        return LaneName(
            plain(road_clauses.put(clause, **slots)), "xb" in slots_of(clause), kind in ("left", "turn_left")
        )
    use = leg.turns_in[number - 1] if leg.turns_in and number else ""
    if use in ("left", "right") and rng.random() < 0.85:
        return _named(_one(rng, clause_words.LANE["turn"]), xb, use == "left", use=use)
    through = sum("through" in u for u in leg.turns_in)
    if use == "through" and through == 1 and rng.random() < 0.4:
        return _named(_one(rng, clause_words.LANE["through"]), xb, True)
    lanes = max(leg.lanes_in, 1)
    if lanes == 1 or number is None:
        return _named(_one(rng, clause_words.LANE["uncounted"]), xb)
    return _numbered(rng, number, lanes, use, xb)


def _numbered(rng: Random, number: int, lanes: int, use: str, xb: str) -> LaneName:
    """A lane of several by its number or its side."""
    sided: tuple[str, ...] = ()
    if number == 1:
        sided = clause_words.LANE["right"].side(False) * 2
    elif number == lanes and use != "left":
        sided = clause_words.LANE["left"].side(False) * 2
    elif lanes == 3 and number == 2:
        sided = clause_words.LANE["middle"].side(False) * 3
    form = rng.choice(clause_words.LANE["numbered"].side(False) + sided)
    counts = {"number": NUMBERS[number], "ordinal": ORDINALS[number], "short": SHORT_ORDINALS[number]}
    return _named(form, xb, number == lanes and form in sided, digit=str(number), **counts)


def _named(form: str, xb: str, from_left: bool = False, **slots: str) -> LaneName:
    return LaneName(form.format(xb=xb, **slots), "xb" in slots_of(form), from_left)


def _kind_of_lane(rng: Random, leg: Leg, number: int | None) -> str:
    """Which list of `road_clauses.LANE` names a lane; "" if none does."""
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
        return "a " + plain(road_clauses.phrase(rng, road_clauses.JUNCTION[crash.layout]))
    return "a " + _one(rng, clause_words.JUNCTION[FOUR if crash.layout == FOUR else T])


def person(rng: Random) -> dict[str, str]:
    """Age, sex and pronouns of an occupant."""
    age, male = rng.randint(16, 88), rng.random() < 0.5
    return {
        "age": _one(rng, clause_words.AGE).format(age=age), "sex": "male" if male else "female",
        "He": "He" if male else "She", "he": "he" if male else "she",
        "his": "his" if male else "her", "His": "His" if male else "Her",
    }  # fmt: skip
