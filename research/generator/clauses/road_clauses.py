"""Noun phrases for roads, lanes, junctions, limits and directions, beside those of `clause_words`.

Slots: {noun} "urban road", {n} all its lanes ("four"), {each} lanes each way ("two lanes"), {lanes} of a one-way
road, {a} {b} "two northbound lanes" of either way, {median} a phrase of MEDIAN, {xb} "northbound", {mph} {kph},
{number} {ordinal} of a lane counted from the right, {word} "north". STEM says where the leg lies that ends at the road:
{through} {ending} "north/south" of the through road and of the other, {stemdir} "south", {opposite} "north". They only
train: nothing here is held out. UNCOUNTED, ONE_WAY_AGAIN, TWO_WAY_AGAIN and FLOWS say whether a road is one-way and
leave its lanes open.

Sentences: PAIR tells both roads of a junction at once ({one} and {other} with their articles, {a1} and {a2} their
axes), LIMITS one {lim} that holds on both, ALIKE {each} direction's lanes of both ({total} together), EACH_WAY the
lanes of a road ({axis0}) that has {each} either way ({w1}, {w2}).
"""

from __future__ import annotations

from random import Random

from research.generator import phrase_labels
from research.generator.grammar import clause_of, fill
from research.generator.records import Group, read

_LISTS = read("road")

ROAD_WORD: Group = _LISTS["ROAD_WORD"]
EVEN: Group = _LISTS["EVEN"]
DIVIDED: Group = _LISTS["DIVIDED"]
MEDIAN: dict[str, Group] = _LISTS["MEDIAN"]
CENTER_TURN: Group = _LISTS["CENTER_TURN"]
ONE_WAY: Group = _LISTS["ONE_WAY"]
UNCOUNTED: Group = _LISTS["UNCOUNTED"]
ONE_WAY_AGAIN: Group = _LISTS["ONE_WAY_AGAIN"]
TWO_WAY_AGAIN: Group = _LISTS["TWO_WAY_AGAIN"]
FLOWS: Group = _LISTS["FLOWS"]
SIDES: Group = _LISTS["SIDES"]
JUNCTION: dict[str, Group] = _LISTS["JUNCTION"]
LIMIT: Group = _LISTS["LIMIT"]
LANE: dict[str, Group] = _LISTS["LANE"]
DIRECTION: Group = _LISTS["DIRECTION"]
STEM: dict[str, Group] = _LISTS["STEM"]
PAIR: Group = _LISTS["PAIR"]
LIMITS: Group = _LISTS["LIMITS"]
EACH_WAY: Group = _LISTS["EACH_WAY"]
ALIKE: dict[str, Group] = _LISTS["ALIKE"]


def phrase(rng: Random, options: Group, **slots: str) -> str:
    """One phrase that trains, its slots filled; its labels stay in it."""
    return put(clause_of(rng, options, False), **slots)


def put(clause: str, **slots: str) -> str:
    """A clause, its choices made, with its slots filled and its labels behind it."""
    return phrase_labels.marked(fill(clause, slots.__getitem__), tuple(phrase_labels.labels_of(clause)))
