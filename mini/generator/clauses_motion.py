# ruff: noqa: E501 - one clause a line
"""Clauses about motion and contact. {V} {W} {U} mention a vehicle, {Vf} introduces it with year and model.

{dir} {xb} heading, {lane} lane, {road} the road with lanes, {appr} what it approaches, {turn} left or right.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

APPROACH = clauses("""
{Vf} was traveling {dir} in the {lane} of {road}{appr}
{Vf} was traveling {dir} [on|along] {road}{appr}
{Vf} was traveling {xb} in the {lane}[ of {road}|]{appr}
{Vf} was {xb} [in the {lane}|on {road}|in the {lane} of {road}]{appr}
{Vf} was [proceeding|driving|heading|moving] {dir} [in the {lane}|on {road}]{appr}
{Vf} [was driven|drove|was operating|traveled] {xb} [on|along] {road}[ in the {lane}|]{appr}
{Vf} had been traveling {dir} in the {lane}{appr}
~{Vf} was on {road} and [headed|going] {dir}[ in the {lane}|]{appr}
~Heading {dir} [on {road}|in the {lane}] was {Vf}{appr}
~{Vf} came from the {from} [in the {lane}|on {road}]{appr}
""")
"""{appr} may be empty."""

APPROACH_STOPPED = clauses("""
{Vf} was stopped {xb} in the {lane}{why}
{Vf} was stopped [facing {dir}|in the {xb} lane][ of {road}|]{why}
{Vf} was stopped in the {lane} of {road}, facing {dir}{why}
{Vf} had [stopped|come to a stop] [in the {lane}|] [while traveling {dir}|facing {dir}]{why}
{Vf} was traveling {dir} [in the {lane}|on {road}] and [had stopped|came to a stop|was stopped]{why}
~{Vf}, pointed {dir}, stood still [in the {lane}|on {road}]{why}
~{Vf} sat [motionless|at rest] in the {lane}, facing {dir}{why}
""")

APPROACH_SLOWING = clauses("""
{Vf} was traveling {dir} [in the {lane}|on {road}] and was [slowing|decelerating|slowing down|braking]{why}
{Vf} was {xb} [in the {lane} |]and [began to slow|slowed|was slowing]{why}
~{Vf}, {xb}, was losing speed [in the {lane}|]{why}
""")

APPROACH_PARKED = clauses("""
{Vf} was [legally |]parked [on the right side of the road|along the right curb|on the right shoulder][, unoccupied,|] facing {dir}
{Vf} was parked and unoccupied[ on {road}|], facing {dir}
~{Vf} had been left at the curb, facing {dir}
""")

APPROACH_CURVE = clauses("""
{Vf} was traveling {dir} [in the {lane}|on {road}] and was [negotiating|entering|exiting|rounding] a {curve} curve
{Vf} was [negotiating|rounding] a curve to the {curve} [while traveling|, heading|, going] {dir} [in the {lane}|on {road}]
~{Vf}, {xb}, was in a {curve}-hand bend [of {road}|]
""")

WHY = {
    "light": "[for a red light|at a red light|waiting for the light to change|for a red traffic signal|for the traffic signal|~while the signal was red]",
    "sign": "[at the stop sign|for the stop sign|~before the stop sign]",
    "traffic": "[for traffic ahead|in traffic|due to stopped traffic|for traffic|because traffic had backed up|for a vehicle ahead|~in a line of cars]",
    "turn_left": "[waiting to turn left|waiting to make a left turn|preparing to turn left|to make a left turn into a driveway|in order to turn left|~with its left blinker on]",
    "turn_right": "[waiting to turn right|preparing to turn right|to make a right turn|in order to turn right|~with its right blinker on]",
}

SAME = clauses("""
{Vf} was [also |]traveling {dir} [in the {lane}|on the same road[way|]] [directly |]behind {W}
{Vf} was {xb} [in the same lane|on the same roadway] [behind|following] {W}
{Vf} was following {W}[ {dir}| in the {lane}|]
{Vf} was traveling in the same direction behind {W}
~{Vf} came up from behind {W}[ in the same lane|]
~Behind {W} was {Vf}[, also {xb}|]
""")

AHEAD = clauses("""
{Vf} was [also |]{xb} [in the same lane|on the same roadway] [directly |]ahead of {W}
{Vf} was traveling {dir} ahead of {W}[ in the {lane}|]
~In front of {W} was {Vf}[, also {xb}|]
""")

INTENT = {
    "straight": "[intending to go straight|intending on going straight|intending to travel straight through|going straight|~meaning to continue straight]",
    "turn_left": "[intending to turn left|intending on turning left|attempting to make a left turn|about to turn left|~meaning to go left]",
    "turn_right": "[intending to turn right|intending on turning right|attempting a right turn|about to turn right|~meaning to go right]",
    "u_turn": "[intending to make a U-turn|~wanting to turn around]",
}

CRITICAL = {
    "crossing": clauses("""
[Both vehicles|{V} and {W}] entered the intersection [at the same time|at approximately the same time|]
{V} entered the intersection [and failed to yield to {W}|against the red light|without stopping|]
The driver of {V} [failed to stop at the stop sign|proceeded through the intersection|ran the red light|attempted to cross the intersection]
{V} [proceeded|started] into the intersection [in front of|into the path of] {W}
As {V} was crossing the intersection, {W} [also entered|entered the intersection]
~{V} pulled across the [path|lane] of {W}
~{V} drove through the intersection and {W} could not stop
"""),
    "left_opposite": clauses("""
{V} attempted to turn left [at the intersection|in front of {W}|across the path of {W}|]
The driver of {V} [attempted|began] to [make a left turn|turn left] [at the intersection |]and failed to yield to {W}
As {W} was going straight, {V} turned left across its path
{V} [began|started|initiated] a left turn [in front of|across the path of|and entered the path of] {W}
{V} turned left in front of {W}
~{V} swung left [into the way|in front] of the oncoming {W0}
~Making a left, {V} cut off {W}
"""),
    "turn_left": clauses("""
{V} [attempted|began|started] to [turn left|make a left turn] [onto the {axis2} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn left [in front of|into the path of] {W}
The driver of {V} attempted to turn left [and|but] failed to yield to {W}
{V} [entered the roadway|entered the intersection], turning left, [into|across] the path of {W}
{V} turned left in front of {W}
~{V} nosed out to go left and got in the way of {W}
~Making a left, {V} cut off {W}
"""),
    "turn_right": clauses("""
{V} [attempted|began|started] to [turn right|make a right turn] [onto the {axis2} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn right [in front of|into the path of] {W}
{V} turned right [in front of|into the path of] {W}
~Making a right, {V} cut off {W}
~{V} nosed out to go right and got in the way of {W}
"""),
    "rear_end": clauses("""
The driver of {V} [did not see|failed to notice] {W} [stopped|slowing] ahead
{V} [did not slow|was unable to stop in time|failed to stop|could not stop]
{W} [slowed|was stopped] and {V} [did not|failed to slow]
~{V} did not brake soon enough
"""),
    "head_on": clauses("""
{V} [crossed|crossed over|drifted across|went over] the [centerline|center line|double yellow line][ into the {opp} lane| and entered the {opp} lane|]
For an unknown reason, {V} [drifted|veered] to the left [and into|into] the {opp} lane
The driver of {V} lost control [on the {surf0} road |]and [crossed the centerline|entered the {opp} lane|drove left-of-center]
{V} traveled left of center into the path of {W}
~{V} strayed over the middle of the road toward {W}
~{V} wandered into oncoming traffic
"""),
    "lane_change": clauses("""
{V} [attempted to change|changed|began to change] lanes to the {turn}
{V} moved [to the {turn}|into the {turn} lane|{turn} into the lane of {W}]
The driver of {V} did not see {W} and [changed lanes|moved over] to the {turn}
~{V} slid over to the {turn}[, where {W} was|]
"""),
    "departure": clauses("""
{V} [departed|ran off|went off|drifted off] the {turn} side of the road[way|]
The driver of {V} lost control and [departed|ran off|left] the road[way|] [to|on] the {turn}[ side|]
{V} drifted to the {turn} and [departed|left] the road[way|]
~{V} left the pavement on the {turn}
"""),
    "pedestrian": clauses("""
{W} was crossing the road[way|] [in front of {V}|from the {side0}|]
{W} entered the road[way|] [from the {side0}|] [into the path|in front] of {V}
~{W} stepped out ahead of {V}
"""),
    "parked": clauses("""
{V} [drifted to the right|failed to notice the parked vehicle|moved to the right]
~{V} came too close to the curb
"""),
    "u_turn": clauses("""
{V} [attempted|began|started] [to make a|a] U-turn [in front of {W}|]
The driver of {V} made a U-turn [into|across] the path of {W}
~{V} tried to turn around in front of {W}
"""),
    "backing": clauses("""
{V} [was backing|backed] out of [the|a] driveway [into|in] the path of {W}
{V} was backing [onto the road[way|]|from a driveway]
~{V} reversed into the [road|street] ahead of {W}
"""),
    "merge": clauses("""
{V} [attempted to merge|merged|was merging] [into traffic|onto the highway|into the lane of {W}|from the ramp]
~{V} tried to squeeze in from the ramp
"""),
    "overtaking": clauses("""
{V} attempted to [pass|overtake] [another vehicle|a slower vehicle|on the left][ and entered the {opp} lane|]
{V} was passing [on the left|a slower vehicle] in the {opp} lane
~{V} pulled out to get around a slow vehicle
"""),
}

AVOID = clauses("""
The driver of {W} [braked|steered {anyside}|braked and steered {anyside}|swerved to the {anyside}] but [was unable to|could not] avoid [contact|the collision|{V}]
The driver of {V} did not take any avoidance actions
Neither driver attempted any [evasive|avoidance] actions
{W} [braked|applied the brakes][ with lockup|] and steered {anyside}
~Hard braking by {W} did not help
~{W} swerved {anyside}
""")

IMPACT = clauses("""
The {sa} of {S} [struck|struck|struck|impacted|contacted|hit|made contact with|collided with] the {ta} of {T}
The {sa} of {S} [struck|impacted|struck] the {ta} of {T}[ in a [T|L]-type configuration| in an offset-frontal mode| in the {xb} lane|]
{S} [struck|hit|impacted|contacted] {T} [in|on] the {ta} with its {sa}
{S}'s {sa} [struck|impacted|contacted|hit] {T}'s {ta}
{S}'s {sa} [struck|impacted|made contact with] the {ta} of {T}
{T} was [struck|hit|impacted|struck] [in|on] the {ta} by the {sa} of {S}
{T}'s {ta} was [struck|contacted|impacted] by [the {sa} of {S}|{S}'s {sa}]
The {ta} of {T} was [struck|hit|impacted|contacted] by the {sa} of {S}
The {sa} of {S} [and|came into contact with|contacted] the {ta} of {T}[ made contact|]
{S} [struck|impacted] the {ta} of {T} with [its|it's] {sa}
{T} [was then|was] [struck|contacted] [in|on] its {ta} by {S}[ with its {sa}|]
~Contact was made between the {sa} of {S} and the {ta} of {T}
~{T} took the {sa} of {S} in its {ta}
~The {ta} of {T} met the {sa} of {S}
~With its {sa}, {S} ran into the {ta} of {T}
~Into the {ta} of {T} went the {sa} of {S}
""")

IMPACT_REAR = clauses("""
{S} rear-ended {T}
{S} [struck|hit|impacted] {T} from behind
{T} was [rear-ended|struck from behind|hit from behind] by {S}
{S} collided with the back of {T}
~{S} ran into {T} from behind
~{T} was bumped from the rear by {S}
""")

IMPACT_BARE = clauses("""
{S} [struck|hit|impacted|collided with] {T}
{T} was [struck|hit] by {S}
The vehicles collided
~{S} crashed into {T}
~{T} got hit by {S}
""")

SWIPE = clauses("""
{S} and {T} sideswiped, {S}'s {sa} [side |]against {T}'s {ta} side
The {sa} [side |]of {S} sideswiped the {ta} side of {T}
The {sa} [side |]of {S} [struck|contacted|made contact with] the {ta} side of {T}
~{S} scraped its {sa} side along the {ta} side of {T}
""")

THEN = clauses("""
The {sa} of {S} then [struck|impacted|contacted] the {ta} of {T}
{T} was then [struck|hit] [in|on] the {ta} by {S}
{S} was pushed [forward |]and its {sa} [struck|contacted] the {ta} of {T}
~Next, {S} ran its {sa} into the {ta} of {T}
""")
THEN_REAR = clauses("""
{S} was pushed [forward |]into [the rear of |the back of |]{T}
The front of {S} then [struck|impacted] the [rear|back] of {T}
~This knocked {S} into the vehicle in front of it, {T}
""")

AREA = {
    "front": "front|front|front|front end|[left|right] front|front [left|right]|~nose|~front bumper",
    "back": "back|rear|rear|rear end|back end|[left|right] rear|rear [left|right] corner|~tail|~rear bumper",
    "left": "left side|left side|left side|left|driver's side|driver side|left front side|left-side|~left flank|~driver's door",
    "right": "right side|right side|right side|right|passenger side|passenger's side|right front side|right-side|~right flank|~passenger door",
}

REST = clauses("""
{V} [rotated|spun] [clockwise|counterclockwise|counter-clockwise][ {deg} degrees|] and came to [rest|final rest] [in the intersection|off the roadway|on the roadway|in the road][ facing {any8}|]
Both vehicles came to [rest|final rest] [in the intersection|near impact|on the roadway|off the road][ facing {any8}|]
{V} came to [rest|final rest] facing {any8}[; {W} came to final rest facing {any8b}|]
{V} continued {any8} and came to rest [{m}m|{m} meters|{m} feet] {any8b} of impact
The impact caused {V} to [rotate|spin] [clockwise|counterclockwise] and [depart the road|come to rest facing {any8}]
There was no physical evidence to [support|substantiate] the final rest positions
{V} was pushed [off the road|into the next lane|into a driveway] before coming to rest
~After that {V} rolled to a stop facing {any8}
""")
