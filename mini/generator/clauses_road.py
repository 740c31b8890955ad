# ruff: noqa: E501 - one clause a line
"""Noun phrases for roads, lanes, junctions, limits and directions, beside those that `road_phrases` and `words` build.

Slots: {noun} "urban road", {n} all its lanes ("four"), {each} lanes each way ("two lanes"), {lanes} of a one-way road,
{a} {b} "two northbound lanes" of either way, {median} a phrase of MEDIAN, {xb} "northbound", {mph} {kph}, {number}
{ordinal} of a lane counted from the right, {word} "north". STEM says where the leg lies that ends at the road: {through}
{ending} "north/south" of the through road and of the other, {stemdir} "south", {opposite} "north". They only train: nothing
here is held out. UNCOUNTED, ONE_WAY_AGAIN, TWO_WAY_AGAIN and FLOWS say whether a road is one-way and leave its lanes open.

Sentences: PAIR tells both roads of a junction at once ({one} and {other} with their articles, {a1} and {a2} their axes),
LIMITS one {lim} that holds on both, ALIKE {each} direction's lanes of both ({total} together), EACH_WAY the lanes of a road ({axis0}) that has {each} either way ({w1}, {w2}).
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
UNCOUNTED = clauses("""
a one-way {noun}
a one-way {noun}
a one-way {noun}
a one-way {xb} {noun}
a {xb} one-way {noun}
a {xb}, one-way {noun}
a one-way {noun} [heading|going|leading|running] {xb}
a one-way {noun} for {xb} [traffic|travel]
a {noun} [with one-way|that carries one-way|for one-way] {xb} traffic
a {noun} [open|limited] to {xb} traffic only
a [narrow|short|quiet] one-way {noun}
a {noun} that [is|was] one-way[ {xb}| to {xb} traffic|]
""")
ONE_WAY_AGAIN = clauses("""
the one-way {noun}
the one-way {noun}
the {xb} one-way {noun}
the one-way {xb} {noun}
""")
TWO_WAY_AGAIN = ["the two-way {noun}"]
FLOWS = clauses("""
The {axis0} [road|street|roadway] [is|was] one-way {xb}
The {axis0} [road|street|roadway] [carries|carried|has|had] {xb} traffic only
Only {xb} traffic [is|was] [allowed|permitted] on the {axis0} [road|street]
[Traffic|All traffic] on the {axis0} [road|street] [flows|moves|ran|runs] {xb}
The {axis0} [road|street] [may be|is to be] [used|driven] {xb} only; it is one-way
The {xb} [roadway|road|street|lane] [is|was] [a one-way road|one-way|a one-way street]
""")
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
The {ending} [road|street|roadway] [ends|ended|dead-ends|terminates|stops] at the [intersection|junction], coming [up |]from the {stemdir}
The {ending} [road|street] [joins|meets|runs into|comes out on] the {through} [road|street] on its {stemdir} side
The side [street|road] [is|lies|was] on the {stemdir} side of the [main road|roadway|{through} road]
The side [street|road] [comes|came] up to the {through} road from the {stemdir} and [goes|went] no farther
The {ending} [road|street] [begins|starts] at the [intersection|junction] and [leads|runs|goes] {stemdir}
The [third|remaining] leg of the [intersection|junction] [leads|runs|extends|points] {stemdir}
The stem of the T [points|leads|runs|is] to the {stemdir}
At its {opposite} end the {ending} [road|street] [meets|met|reaches|empties into] the {through} [road|street]
The {through} [road|street] [intersects with|passes|runs past] the {opposite} end of the {ending} [road|street]
[There is|There was] no [leg|road|street|approach] on the {opposite} side of the [intersection|junction|{through} road]
Across from the side street, on the {opposite} side, [there is no road|there are only houses|lies an open field]
[Drivers|Motorists|Traffic] on the {ending} [road|street], which lies {stemdir} of the {through} road, must turn left or right
The intersection has [legs|approaches] on three sides, all but the {opposite}
Its three legs are the {through} road, both ways, and a leg to the {stemdir}
[Running|Coming] from the {stemdir}, the side [street|road] [ended|ends|stops] at the {through} [road|street|highway]
To the {stemdir} a [side street|side road|smaller road] branches off the {through} [road|street|highway]
A [side street|side road] leaves the {through} [road|street|highway] toward the {stemdir}
The [through|main] road [is|was] the {through} one; the other [goes|leads] {stemdir} only
"""),
    "driveway": clauses("""
The driveway [is|was|lies] on the {stemdir} side of the [road|roadway|street]
On the {stemdir} side of the road [is|was] [a driveway|the entrance of a parking lot|a business driveway]
The driveway [opens|opened] onto the {through} road from its {stemdir} side
The driveway [leads|runs|goes] {stemdir} from the [road|roadway|street]
The [lot|property|business] to which the driveway belongs [lies|is] {stemdir} of the [road|street]
To the {stemdir} [of the road |][there is|there was] a [private |]driveway
The {stemdir} curb [is|was] [broken|interrupted|cut] by a driveway
"""),
}

PAIR = clauses("""
The {a1} [road|street|roadway] [is|was] {one}, [and|while] the {a2} [road|street|roadway|one] [is|was] {other}
[The road|The street|The roadway] [running|going|that runs] {a1} [is|was] {one}; [the one|that] [running|going|that runs] {a2} [is|was] {other}
{Ione} [running|that runs|going|which ran] {a1} [meets|intersects|met|joined] {other} [running|that runs|going|which ran] {a2} [here|at this point|there|at this location]
[Of the two roads|Of the two streets], the {a1} [one|road] [is|was] {one} and the {a2} [one|road] {other}
[Running|Going] {a1} [is|was] {one}; [running|going] {a2} [is|was] {other}
{a1}: {one}; {a2}: {other}
[Traffic|A driver|Someone] [going|travelling] {a1} [uses|has|is on] {one}, [traffic|a driver|someone] [going|travelling] {a2} [uses|has|is on] {other}
[The layout is|It is|This is] {one} that [goes|runs|leads] {a1} and {other} that [goes|runs|leads] {a2}
The {a1} [road|street] consists of {one}, the {a2} [road|street] of {other}
[Here|There|At this corner] {one} ({a1}) and {other} ({a2}) [meet|come together]
The {a1} [approaches|legs] [belong to|are of|are part of] {one} and the {a2} [approaches|legs] [to|of] {other}
[Besides|Next to] the {a2} [road|street], which [is|was] {other}, there [is|was] the {a1} [road|street], {one}
""")
LIMITS = clauses("""
The [posted |]speed limit on both [roads|roadways|streets] [was|is] {lim}
Both [posted |]speed limits [were|are] {lim}
[Both|The two] [roads|roadways|streets] [had|have|carried|carry] a [posted |]speed limit of {lim}
[Both|The two] [roads|roadways|streets] [were|are] [posted|signed|limited|marked] at {lim}
The [speed |]limit [for|of|on] [both roads|both roadways|both streets|either road|each street|either roadway] [was|is] {lim}
[Each|Either] [road|street|roadway] [had|has] a [speed |]limit of {lim}
[On both|On either of the|For both] [roads|streets|roadways] the [posted |][speed |]limit [is|was] {lim}
{lim} [was|is] the speed limit [for all|for all approaches|on all legs|for everyone here|in all directions]
All [approaches|legs] [had|have|share|shared] [a|the same] [speed |]limit of {lim}
The [speed |]limit [did|does] not differ between the roads: {lim}[ everywhere|]
The [posted |]speed limits of the two [roads|streets] [were|are] the same, {lim}
No matter which [road|street] one [drove|drives] on, [no more than |]{lim} [was|is] [allowed|permitted|the limit]
[The whole area|The neighborhood|The entire intersection] [has|had] a {lim} [speed |]limit
""")
EACH_WAY = clauses("""
[It has|It had] {each} in both the {w1} and [the |]{w2} directions
The {axis0} [road|street|roadway] [had|has] {each} in both the {w1} and [the |]{w2} direction[s|]
The {axis0} [road|street|roadway] [has|had|carries|carried] {each} [each way|either way|in each direction|in either direction|both ways]
[Both|The] {b1} and {b2} [traffic|drivers|motorists] [had|have|are given|were given] {each}[ each| apiece| of their own|]
{b1} and {b2} [traffic|drivers] [each have|each had|both have|both had] {each}
The {axis0} [road|street|roadway] [has|had|offers] {each} for {b1} and {each} for {b2} [traffic|travel]
The {axis0} [road|street|roadway] [offers|offered|provides|provided] {each} [to|for] [either|each] direction
In [either direction|both directions] the {axis0} [road|street|roadway] [has|had|provides] {each}
[It has|It had|The {axis0} road has] {each} [running|going|leading] {w1} and {each} {w2}
The {axis0} [road|street|roadway] [is|was] {each} wide [each way|in each direction|per direction]
""")
ALIKE = {
    "two_way": clauses("""
Both [roads|roadways|streets] [had|have|were posted as having] {each} [in each direction|each way|in either direction|per direction]
The two [roads|roadways|streets] [each |]had {each} [in each direction|each way|in either direction]
[Both|The two|The intersecting] [roads|roadways|streets] [were|are] {total}-lane [roads|roadways|streets]
[Each|Either] of the [roads|roadways|streets] [is|was] {each} wide [in each direction|each way]
[Both|The two] [roads|roadways|streets] [consist|consisted] of {total} lanes, {each} [in each direction|each way]
[All|Both] [approaches|roads] [had|have] {total} lanes [in all|together|counting both directions]
"""),
    "one_way": clauses("""
Both [roads|roadways|streets] [were|are] one-way [with|and had] {each}[ of travel| of traffic|]
Both one-way [roads|roadways|streets] [had|have] {each}[ of travel| of traffic|]
Each one-way [road|roadway|street] [had|has|carried|consisted of] {each}[ of travel| of traffic|]
The two [roads|roadways|streets], both one-way, had {each}[ each| apiece|]
This is where two one-way [roads|roadways|streets] of {each}[ each|] [cross|meet|intersect]
[Both|The two] [were|are] one-way streets, {each} wide
The [crash|collision] [occurred|happened|took place] [in|at|within] the [intersection|crossing] of two one-way [streets|roads|roadways]; both [had|have] {each}[ of travel|]
Two one-way [streets|roads] [cross|meet] here, [both|each] with {each}
"""),
}

enlarge("road", globals())


def phrase(rng: Random, options: list[str], **slots: str) -> str:
    """One phrase, its slots filled."""
    return fill(clause_of(rng, options, False), slots.__getitem__)
