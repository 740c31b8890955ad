# ruff: noqa: E501 - one clause a line
"""Noun phrases for roads, lanes, junctions, limits and directions, beside those that `road_phrases` and `words` build.

Slots: {noun} "urban road", {n} all its lanes ("four"), {each} lanes each way ("two lanes"), {lanes} of a one-way road,
{a} {b} "two northbound lanes" of either way, {median} a phrase of MEDIAN, {xb} "northbound", {mph} {kph}, {number}
{ordinal} of a lane counted from the right, {word} "north". STEM says where the leg lies that ends at the road: {axis}
{axis2} "north/south" of the through road and of the other, {stemdir} "south", {opposite} "north". They only train: nothing
here is held out.
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

STEM = {
    "t": clauses("""
The {axis2} [road|street|roadway] [ends|ended|dead-ends|terminates|stops] at the [intersection|junction], coming [up |]from the {stemdir}
The {axis2} [road|street] [joins|meets|runs into|comes out on] the {axis} [road|street] on its {stemdir} side
The side [street|road] [is|lies|was] on the {stemdir} side of the [main road|roadway|{axis} road]
The side [street|road] [comes|came] up to the {axis} road from the {stemdir} and [goes|went] no farther
The {axis2} [road|street] [begins|starts] at the [intersection|junction] and [leads|runs|goes] {stemdir}
The [third|remaining] leg of the [intersection|junction] [leads|runs|extends|points] {stemdir}
The stem of the T [points|leads|runs|is] to the {stemdir}
At its {opposite} end the {axis2} [road|street] [meets|met|reaches|empties into] the {axis} [road|street]
The {axis} [road|street] [intersects with|passes|runs past] the {opposite} end of the {axis2} [road|street]
[There is|There was] no [leg|road|street|approach] on the {opposite} side of the [intersection|junction|{axis} road]
Across from the side street, on the {opposite} side, [there is no road|there are only houses|lies an open field]
[Drivers|Motorists|Traffic] on the {axis2} [road|street], which lies {stemdir} of the {axis} road, must turn left or right
The intersection has [legs|approaches] on three sides, all but the {opposite}
Its three legs are the {axis} road, both ways, and a leg to the {stemdir}
[Running|Coming] from the {stemdir}, the side [street|road] [ended|ends|stops] at the {axis} [road|street|highway]
To the {stemdir} a [side street|side road|smaller road] branches off the {axis} [road|street|highway]
A [side street|side road] leaves the {axis} [road|street|highway] toward the {stemdir}
The [through|main] road [is|was] the {axis} one; the other [goes|leads] {stemdir} only
"""),
    "driveway": clauses("""
The driveway [is|was|lies] on the {stemdir} side of the [road|roadway|street]
On the {stemdir} side of the road [is|was] [a driveway|the entrance of a parking lot|a business driveway]
The driveway [opens|opened] onto the {axis} road from its {stemdir} side
The driveway [leads|runs|goes] {stemdir} from the [road|roadway|street]
The [lot|property|business] to which the driveway belongs [lies|is] {stemdir} of the [road|street]
To the {stemdir} [of the road |][there is|there was] a [private |]driveway
The {stemdir} curb [is|was] [broken|interrupted|cut] by a driveway
"""),
}

enlarge("road", globals())


def phrase(rng: Random, options: list[str], **slots: str) -> str:
    """One phrase, its slots filled."""
    return fill(clause_of(rng, options, False), slots.__getitem__)
