"""Noun phrases for roads, lanes, junctions, limits and directions, beside those that `road_phrases` and `words` build.

Slots: {noun} "urban road", {n} all its lanes ("four"), {each} lanes each way ("two lanes"), {lanes} of a one-way road,
{a} {b} "two northbound lanes" of either way, {median} a phrase of MEDIAN, {xb} "northbound", {mph} {kph}, {number}
{ordinal} of a lane counted from the right, {word} "north". They only train: nothing here is held out.
"""

from __future__ import annotations

from random import Random

from mini.generator.further import enlarge
from mini.generator.grammar import clause_of, clauses, fill, tables

ROAD_WORD = ["road", "roadway", "street", "highway", "trafficway"]

EVEN = clauses("""
a {n}-lane, two-way {noun}
a two-way {noun} with {each} in each direction
""")
DIVIDED = clauses("""
a {n}-lane, divided {noun}
a {n}-lane {noun} {median}
a divided {noun} with {each} in each direction
""")
MEDIAN = tables(
    grass="divided by a grass median",
    barrier="divided by a concrete barrier",
    raised="divided by a raised median",
    painted="divided by a painted median",
)
CENTER_TURN = [
    "a {n}-lane, two-way {noun} with a center turn lane",
    "a {noun} with {each} in each direction and a center turn lane",
]
ONE_WAY = ["a {n}-lane, one-way {noun}", "a one-way {xb} {noun} with {lanes}"]
SIDES = ["a {noun} with {a} and {b}"]
JUNCTION = tables(four="four-leg intersection|4-way intersection", t="T-intersection|three-legged intersection")
LIMIT = ["{mph} mph", "{kph} kmph ({mph} mph)"]
LANE = tables(
    right="right lane",
    left="left lane",
    middle="middle lane",
    only="{xb} lane",
    turn_left="left-turn lane",
    turn_right="right turn lane",
    numbered="lane {number}|{ordinal} lane",
)
DIRECTION = ["{word}", "to the {word}"]

enlarge("road", globals())


def phrase(rng: Random, options: list[str], **slots: str) -> str:
    """One phrase, its slots filled."""
    return fill(clause_of(rng, options, False), slots.__getitem__)
