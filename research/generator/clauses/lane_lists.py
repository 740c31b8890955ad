"""Lists of the lanes of a road, item by item: in brackets behind its name, and in a sentence about both ways."""

from __future__ import annotations

from random import Random

from research.generator import phrase_notes, words
from research.generator.clauses.clause_words import IN_BRACKETS
from research.generator.crash.world import Leg


def split(rng: Random, leg: Leg, back: Leg, xb: str, yb: str, held_out: bool) -> str:
    """The bracket that tells lanes each way: (two lanes northbound, center turn lane, two lanes southbound)."""
    plain = held_out or rng.random() < 0.4
    listed = lane_list if plain else _further_lanes
    ways = [lanes for lanes in (listed(rng, leg, xb), listed(rng, back, yb)) if lanes]
    dividers = IN_BRACKETS[leg.median].side(False) if leg.median in IN_BRACKETS else ()
    middles = ("center turn lane",) if leg.twltl else dividers
    middle = [middles[0] if plain else rng.choice(middles)] if middles and len(ways) == 2 else []
    if plain:
        return f"({', '.join([ways[0], *middle, *ways[1:]])})"
    if rng.random() < 0.3:
        ways.reverse()
    text = rng.choice((", ", ", ", "; ")).join([ways[0], *middle, *ways[1:]])
    head, comma, tail = text.rpartition(", ")
    if comma and rng.random() < 0.6:
        text = f"{head}{rng.choice((', and ', ' and '))}{tail}"
    return rng.choice(("({})", "({})", "({})", "with {}", "made up of {}", "- {} -", "that has {}")).format(text)


def lane_list(rng: Random, leg: Leg, xb: str) -> str:
    """`one northbound left-turn lane, two northbound through lanes`."""
    if not leg.lanes_in:
        return ""
    left, right = leg.turns_in.count("left"), leg.turns_in.count("right")
    plain = leg.lanes_in - left - right
    parts = [phrase_notes.item(f"one {xb} left-turn lane", leg.bearing, "left", 1)] * bool(left)
    if plain:
        word = "through-lane" if leg.turns_in and rng.random() < 0.5 else "lane"
        some = rng.choice(
            (
                f"{words.NUMBERS[plain]} {xb} {word}",
                f"{words.NUMBERS[plain]} {word}{'s' * (plain > 1)} {xb}",
                f"{words.NUMBERS[plain]} {xb} {word}{'s' * (plain > 1)}",
            )
        )
        parts.append(phrase_notes.item(some, leg.bearing, "through", plain))
    parts += [phrase_notes.item(f"one {xb} right-turn lane", leg.bearing, "right", 1)] * bool(right)
    return ", ".join(parts)


_WAYS = {
    "": ("lane", "travel lane", "lane"),
    "through": ("through lane", "through-lane", "lane", "travel lane", "straight lane"),
    "left": ("left turn lane", "left-turn lane", "left turn only lane", "left turn bay", "lane for left turns"),
    "right": ("right turn lane", "right-turn lane", "right turn only lane", "right turn bay", "lane for right turns"),
}


def _further_lanes(rng: Random, leg: Leg, xb: str) -> str:
    """The same from either side of the approach, with more words and numbers."""
    if not leg.lanes_in:
        return ""
    left, right = leg.turns_in.count("left"), leg.turns_in.count("right")
    through = leg.lanes_in - left - right
    counts = [("left", left), ("through" if left + right else "", through), ("right", right)]
    if rng.random() < 0.5:
        counts.reverse()
    if rng.random() < 0.25:
        rng.shuffle(counts)
    behind = rng.random() < 0.3
    parts = []
    for use, count in counts:
        if count:
            word = rng.choice(_WAYS[use])
            word = word.replace("lane", "lanes", 1).replace("bay", "bays") if count > 1 else word
            number = rng.choice(
                (words.NUMBERS[count], words.NUMBERS[count], str(count), *(("a", "a single") if count == 1 else ()))
            )
            some = f"{number} {word} {xb}" if behind else f"{number} {xb} {word}"
            parts.append(phrase_notes.item(some, leg.bearing, use or "through", count))
    return ", ".join(parts)


def lane_phrase(rng: Random, leg: Leg) -> str:
    """`two through lanes and a left-turn lane`, `three lanes, one of them for right turns`, `a single lane`."""
    if not leg.lanes_in:
        return "no lanes"
    uses = [use for use in ("left", "right") if use in leg.turns_in]
    plain = leg.lanes_in - len(uses)
    number = rng.choice((words.NUMBERS[leg.lanes_in], words.NUMBERS[leg.lanes_in], str(leg.lanes_in)))
    if not uses:
        some = rng.choice((f"{number} lane", "one lane", "a single lane") if plain == 1 else (f"{number} lanes",) * 3)
        return phrase_notes.item(some, leg.bearing, "through", plain)
    through = phrase_notes.item(
        f"{words.NUMBERS[plain]} through lane{'s' * (plain > 1)}", leg.bearing, "through", plain
    )
    if not plain or rng.random() < 0.2:
        return f"{number} lane{'s' * (leg.lanes_in > 1)}, one of them for " + " and one for ".join(
            f"{u} turns" for u in uses
        )
    parts = [phrase_notes.item(f"a {use}{rng.choice((' ', '-'))}turn lane", leg.bearing, use, 1) for use in uses]
    parts.insert(rng.choice((0, len(parts))), through)
    listed = ", ".join(parts[:-1]) + f" and {parts[-1]}"
    return f"{number} lanes, {listed}" if rng.random() < 0.25 else listed
