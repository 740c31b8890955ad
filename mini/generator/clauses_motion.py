# ruff: noqa: E501 - one clause a line
"""Clauses about motion and contact. {V} {W} {U} mention a vehicle, {Vf} introduces it with year and model.

{dir} {xb} heading, {lane} lane, {road} the road with lanes, {appr} what it approaches, {turn} left or right.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

APPROACH = clauses("""
The driver of {Vf} was [traveling|driving|going] {xb} [in the {lane}|on {road}|]{appr}
{Vf} was in the {lane}[ of {road}|], traveling {dir}{appr}
{Vf} was occupying the {lane} [while |]traveling {dir}{appr}
{Vf} continued {dir} [in the {lane}|on {road}|]{appr}
[Prior to the crash|Before the crash|Just prior to impact|Initially], {Vf} was traveling {dir} [in the {lane}|on {road}]{appr}
[Meanwhile|At the same time], {Vf} was [traveling|heading] {xb} [in the {lane}|on {road}]{appr}
{Vf} was {xb} and occupied the {lane}{appr}
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
The driver of {Vf} was stopped {xb} [in the {lane}|]{why}
{Vf} was [waiting|at a stop] in the {lane}, {xb}{why}
{Vf} had been traveling {dir} and was now stopped{why}
{Vf} came to a [complete |full |]stop [in the {lane}|] [while {xb}|facing {dir}]{why}
{Vf} was stopped {xb} in the {lane}{why}
{Vf} was stopped [facing {dir}|in the {xb} lane][ of {road}|]{why}
{Vf} was stopped in the {lane} of {road}, facing {dir}{why}
{Vf} had [stopped|come to a stop] [in the {lane}|] [while traveling {dir}|facing {dir}]{why}
{Vf} was traveling {dir} [in the {lane}|on {road}] and [had stopped|came to a stop|was stopped]{why}
~{Vf}, pointed {dir}, stood still [in the {lane}|on {road}]{why}
~{Vf} sat [motionless|at rest] in the {lane}, facing {dir}{why}
""")

APPROACH_SLOWING = clauses("""
{Vf} was traveling {dir} and [slowed down|reduced its speed|had slowed]{why}
The driver of {Vf}, {xb}, [applied the brakes|slowed the vehicle]{why}
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
{Vf} was [directly |]behind {W} [in the {lane}|], [traveling {dir}|{xb}]
{Vf} followed {W} [in the same lane|in the {lane}]
{W} was followed by {Vf}[ in the {lane}|]
{Vf} was [also |]traveling {dir} [in the {lane}|on the same road[way|]] [directly |]behind {W}
{Vf} was {xb} [in the same lane|on the same roadway] [behind|following] {W}
{Vf} was following {W}[ {dir}| in the {lane}|]
{Vf} was traveling in the same direction behind {W}
~{Vf} came up from behind {W}[ in the same lane|]
~Behind {W} was {Vf}[, also {xb}|]
""")

AHEAD = clauses("""
{Vf} was the [first|lead] vehicle, {xb} [in the {lane}|in front of {W}]
Ahead of {W}, {Vf} was traveling {dir}
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
{V} did not stop [for the stop sign|for the signal|] and entered the intersection
{V} drove straight into the intersection [as {W} was crossing|in front of {W}|]
The driver of {V} thought the way was clear and [started|continued|proceeded] across
{V} [started|attempted] to cross the [road|roadway|street|intersection]
{V} entered the intersection and the driver of {W} did not have time to stop
[Both vehicles|{V} and {W}] entered the intersection [at the same time|at approximately the same time|]
{V} entered the intersection [and failed to yield to {W}|against the red light|without stopping|]
The driver of {V} [failed to stop at the stop sign|proceeded through the intersection|ran the red light|attempted to cross the intersection]
{V} [proceeded|started] into the intersection [in front of|into the path of] {W}
As {V} was crossing the intersection, {W} [also entered|entered the intersection]
~{V} pulled across the [path|lane] of {W}
~{V} drove through the intersection and {W} could not stop
"""),
    "left_opposite": clauses("""
{V} was making a left turn when {W} [entered the intersection|came from the other direction|approached]
The driver of {V} thought there was enough time and turned left
{V} turned left [at the intersection|at the green light|on a green signal] [in front of|across the lane of] {W}, which was [going straight|approaching from the opposite direction]
{W} was coming from the opposite direction as {V} turned left
In the middle of the left turn, {V} was in the lane of {W}
{V} attempted to turn left [at the intersection|in front of {W}|across the path of {W}|]
The driver of {V} [attempted|began] to [make a left turn|turn left] [at the intersection |]and failed to yield to {W}
As {W} was going straight, {V} turned left across its path
{V} [began|started|initiated] a left turn [in front of|across the path of|and entered the path of] {W}
{V} turned left in front of {W}
~{V} swung left [into the way|in front] of the oncoming {W0}
~Making a left, {V} cut off {W}
"""),
    "turn_left": clauses("""
{V} was making a left turn when {W} approached
{V} pulled [out|away] from the stop and turned left
The driver of {V} entered the road to go left and did not see {W}
{V} started out, turning left in front of {W}
{V} [attempted|began|started] to [turn left|make a left turn] [onto the {axis2} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn left [in front of|into the path of] {W}
The driver of {V} attempted to turn left [and|but] failed to yield to {W}
{V} [entered the roadway|entered the intersection], turning left, [into|across] the path of {W}
{V} turned left in front of {W}
~{V} nosed out to go left and got in the way of {W}
~Making a left, {V} cut off {W}
"""),
    "turn_right": clauses("""
{V} was making a right turn when {W} approached
{V} pulled [out|away] and turned right
The driver of {V} turned right without seeing {W}
{V} [attempted|began|started] to [turn right|make a right turn] [onto the {axis2} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn right [in front of|into the path of] {W}
{V} turned right [in front of|into the path of] {W}
~Making a right, {V} cut off {W}
~{V} nosed out to go right and got in the way of {W}
"""),
    "rear_end": clauses("""
{V} approached {W} from the rear
The driver of {V} looked [away|down|to the {anyside}] and did not [see|notice] that {W} had stopped
Traffic slowed and {V} was following too closely
{V} was going too fast to stop behind {W}
The driver of {V} braked but could not avoid {W}
The driver of {V} [did not see|failed to notice] {W} [stopped|slowing] ahead
{V} [did not slow|was unable to stop in time|failed to stop|could not stop]
{W} [slowed|was stopped] and {V} [did not|failed to slow]
~{V} did not brake soon enough
"""),
    "head_on": clauses("""
{V} [left|departed] its lane to the left and entered the opposing lane
{V} went left over the center line and was in the lane of {W}
The driver of {V} fell asleep and [crossed the center line|crossed into opposing traffic]
{V} slid across the center line [toward|in front of] {W}
{V} [crossed|crossed over|drifted across|went over] the [centerline|center line|double yellow line][ into the {opp} lane| and entered the {opp} lane|]
For an unknown reason, {V} [drifted|veered] to the left [and into|into] the {opp} lane
The driver of {V} lost control [on the {surf0} road |]and [crossed the centerline|entered the {opp} lane|drove left-of-center]
{V} traveled left of center into the path of {W}
~{V} strayed over the middle of the road toward {W}
~{V} wandered into oncoming traffic
"""),
    "lane_change": clauses("""
{V} [merged|shifted|steered] into the {turn} lane
The driver of {V} was changing lanes [to the {turn}|from one lane to the {turn} lane] and did not check the mirror
{V} steered {turn} into the lane that {W} occupied
{V} [attempted to change|changed|began to change] lanes to the {turn}
{V} moved [to the {turn}|into the {turn} lane|{turn} into the lane of {W}]
The driver of {V} did not see {W} and [changed lanes|moved over] to the {turn}
~{V} slid over to the {turn}[, where {W} was|]
"""),
    "departure": clauses("""
{V} drove off the {turn} road edge
{V} traveled off the {turn} edge of the road[way|]
The vehicle steered {turn} and [departed|left] the road[way|][ on the {turn} side|]
{V} failed to [follow|negotiate] the road and went off to the {turn}
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
{V} was [making|starting] a U-turn when {W} approached
{V} [attempted|began|started] [to make a|a] U-turn [in front of {W}|]
The driver of {V} made a U-turn [into|across] the path of {W}
~{V} tried to turn around in front of {W}
"""),
    "backing": clauses("""
{V} was in reverse [and entered the road|leaving a driveway]
The driver of {V} backed up and did not see {W}
{V} [was backing|backed] out of [the|a] driveway [into|in] the path of {W}
{V} was backing [onto the road[way|]|from a driveway]
~{V} reversed into the [road|street] ahead of {W}
"""),
    "merge": clauses("""
{V} was entering from the ramp and moved into the lane of {W}
The driver of {V} was merging and did not see {W}
{V} [attempted to merge|merged|was merging] [into traffic|onto the highway|into the lane of {W}|from the ramp]
~{V} tried to squeeze in from the ramp
"""),
    "overtaking": clauses("""
{V} attempted to [pass|overtake] [another vehicle|a slower vehicle|on the left][ and entered the {opp} lane|]
{V} was passing [on the left|a slower vehicle] in the {opp} lane
~{V} pulled out to get around a slow vehicle
"""),
}
