# ruff: noqa: E501 - one clause a line
"""Clauses about motion before the crash. {V} {W} {U} mention a vehicle, {Vf} introduces it with year and model.

{dir} {xb} heading, {lane} lane, {road} the road with lanes, {appr} what it approaches, {turn} left or right.
"""

from __future__ import annotations

from mini.generator.further import enlarge
from mini.generator.grammar import clauses, tables

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
{Vf} was being [driven|operated] {dir} [on|along] {road}[ in the {lane}|]{appr}
{Vf} was being operated {xb} [in the {lane}|on {road}]{appr}
{Vf}, operated by [its owner|a lone driver|its only occupant], was [traveling|heading] {dir} [on {road}|in the {lane}]{appr}
{Vf}, which was [driven by its owner|occupied only by the driver], traveled {dir} in the {lane}[ of {road}|]{appr}
{Vf}, whose driver was alone, was {xb} [on {road}|in the {lane}]{appr}
On {road}, {Vf} was [traveling|proceeding|driving] {dir}[ in the {lane}|]{appr}
In the {lane}[ of {road}|], {Vf} was [traveling|moving|proceeding] {dir}{appr}
While [traveling|proceeding|driving] {dir}, {Vf} [occupied|was using|was positioned in] the {lane}[ of {road}|]{appr}
As it [proceeded|traveled|went] {dir} [on|along] {road}, {Vf} was in the {lane}{appr}
{Vf} [kept to|stayed in|remained in|maintained] the {lane} [as it traveled|while heading] {dir}{appr}
{Vf} [used|was using] the {lane} of {road} to [travel|go|proceed] {dir}{appr}
{Vf} was in the {xb} lane[s|] of {road}{appr}
{Vf} [proceeded|drove|moved|went] {dir} [on|along|down] {road}{appr}
The driver of {Vf} [proceeded|drove|headed|continued] {dir} [in the {lane}|along {road}]{appr}
The driver of {Vf} was operating the vehicle {xb} [on {road}|in the {lane}]{appr}
The operator of {Vf} was [traveling|driving|proceeding] {dir} [on {road}|in the {lane}]{appr}
{Vf} {xb} [in {lane}|on {road}|on {road}, {lane}]{appr}
{Vf}, {xb}, was [traveling|driving|proceeding] [in the {lane}|on {road}]{appr}
{Vf}, [traveling|heading|going] {dir}, [was in|occupied] the {lane}{appr}
{Vf}, traveling {xb} [on|along] {road}, was in the {lane}{appr}
[Seconds before the crash|Prior to impact|Before the collision|Shortly before this crash], the driver of {Vf} was [driving|traveling] {dir} [on {road}|in the {lane}]{appr}
[At the time of the crash|At the time], {Vf} was [moving|proceeding|en route] {dir} [along|on] {road}{appr}
The {lane} of {road} was occupied by {Vf}, which was traveling {dir}{appr}
After entering {road}, {Vf} [proceeded|traveled|was heading] {dir}[ in the {lane}|]{appr}
{Vf} was [on its way|en route] {dir} [in the {lane}|along {road}]{appr}
{Vf} had been [driving|heading|proceeding] {dir} on {road}[ in the {lane}|]{appr}
{Vf} [followed|was following] {road}, heading {dir}{appr}
{Vf} was traveling {dir}; it [was in|occupied] the {lane}[ of {road}|]{appr}
{Vf} was occupied by [one person|a driver and one passenger|the driver only] and was traveling {dir} [in the {lane}|on {road}]{appr}
With [only the driver aboard|one passenger aboard|no passengers], {Vf} was {xb} [on {road}|in the {lane}]{appr}
{Vf} made its way {dir} [along {road}|in the {lane}]{appr}
{Vf} was [traveling|moving|proceeding] in [a|the] {xb} direction [on {road}|in the {lane}]{appr}
~{Vf} was on {road} and [headed|going] {dir}[ in the {lane}|]{appr}
~Heading {dir} [on {road}|in the {lane}] was {Vf}{appr}
~{Vf} came from the {from} [in the {lane}|on {road}]{appr}
""")
"""{appr} may be empty."""

FROM_STEM = {
    "t": clauses("""
{Vf} was on the [side street|side road|street that ends there]{appr}
{Vf} [came|was coming|drove] [up|along|on] the [side street|side road|minor road]{appr}
The driver of {Vf} [was using|drove along|was on] the [road that ends here|side street|minor road]{appr}
{Vf} [had come|came] down the [terminating|ending] road{appr}
On the [side street|side road|stem of the T] was {Vf}{appr}
{Vf} was [leaving|coming out of|about to leave] the [side street|side road]
Out of the [side street|minor road] [came|drove] {Vf}
The one on the [side street|side road|road that ends there] was {Vf}
"""),
    "driveway": clauses("""
{Vf} was [leaving|coming out of|about to leave|at the end of] the driveway
The driver of {Vf} was [leaving|pulling out of|exiting] the [driveway|private drive]
{Vf} [came|drove|pulled] out of the driveway
[From|Out of] the driveway [came|drove] {Vf}
{Vf} was in the driveway, [about to enter|nearing|facing] the road
{Vf} had been in the driveway and [was about to leave it|was driven out of it]
The one in the driveway was {Vf}
"""),
}
"""Of one on the leg that ends at the junction: where that leg is known, so is which way it drove. They only train."""

APPROACH_STOPPED = clauses("""
The driver of {Vf} was stopped {xb} [in the {lane}|]{why}
{Vf} was [waiting|at a stop] in the {lane}, {xb}{why}
{Vf} had been traveling {dir} and was now stopped{why}
{Vf} came to a [complete |full |]stop [in the {lane}|] [while {xb}|facing {dir}]{why}
{Vf} was stopped {xb} in the {lane}{why}
{Vf} was stopped [facing {dir}|{xb} in the {lane}][ of {road}|]{why}
{Vf} was stopped in the {lane} of {road}, facing {dir}{why}
{Vf} had [stopped|come to a stop] [in the {lane}|] [while traveling {dir}|facing {dir}]{why}
{Vf} was traveling {dir} [in the {lane}|on {road}] and [had stopped|came to a stop|was stopped]{why}
{Vf} was at a [complete |full |]stop in the {lane} of {road} while {xb}{why}
The driver of {Vf} had [stopped|brought the vehicle to a stop] [in the {lane}|on {road}], {xb}{why}
The driver of {Vf}, {xb} [in the {lane}|on {road}], [stopped|had come to a stop|was stopped]{why}
{Vf} had been brought to a stop in the {lane} [while {xb}|facing {dir}]{why}
{Vf}, {xb} [in the {lane}|on {road}], [was stopped|had stopped|was at a stop]{why}
{Vf}, which was {xb} in the {lane}, [stopped|came to a stop|had stopped]{why}
[Prior to impact|Before the crash|At the time], {Vf} was stopped [in the {lane}|on {road}], facing {dir}{why}
In the {lane}, {Vf} [was stopped|had stopped] [facing {dir}|while {xb}]{why}
On {road}, {Vf} was stopped [in the {lane} |]facing {dir}{why}
{Vf} was [traveling|heading] {dir} [in the {lane} |on {road} |]until it stopped{why}
{Vf} [traveled|drove|proceeded] {dir} [in the {lane}|on {road}] and then [stopped|came to a stop]{why}
{Vf} was facing {dir} [in the {lane}|on {road}] and was [stopped|not moving|at a full stop]{why}
{Vf} occupied the {lane}, {xb}, [and was stopped|where it had stopped]{why}
{Vf} {xb}, stopped in {lane}{why}
{Vf} stopped {xb} [in {lane}|on {road}]{why}
{Vf} had slowed to a stop [in the {lane} |]while [traveling|heading] {dir}{why}
After traveling {dir} [on {road}|in the {lane}], {Vf} [stopped|had stopped|came to a stop]{why}
While {xb} [in the {lane}|on {road}], {Vf} [had to stop|stopped|was forced to stop]{why}
{Vf} remained stopped [in the {lane} while {xb}|on {road} while {xb}]{why}
The {lane} was occupied by {Vf}, [which was |]stopped facing {dir}{why}
~{Vf}, pointed {dir}, stood still [in the {lane}|on {road}]{why}
~{Vf} sat [motionless|at rest] in the {lane}, facing {dir}{why}
""")

APPROACH_WAITING = clauses("""
{Vf} was stopped {xb} [in the {lane} |]{why}
{Vf} was stopped [facing {dir}|{xb} in the {lane}] {why}
{Vf} had stopped [in the {lane} |]facing {dir}{why}
{Vf} was {xb} and came to a stop [in the {lane} |]{why}
{Vf} was traveling {dir} [in the {lane} |on {road} |]and stopped{why}
The driver of {Vf} was traveling {dir} [on {road} |in the {lane} |]and stopped{why} before proceeding
{Vf}, {xb} [in the {lane}|on {road}], stopped[ briefly|]{why}
{Vf} [was waiting|had been waiting] in the {lane}, facing {dir}{why}
~{Vf} faced {dir} and stood{why} until its driver moved on
""")

PRESENTED = {
    "moving": clauses("""
{Vi} traveling {dir} [in the {lane}|on {road}|in the {lane} of {road}]{appr}
{Vi} [that was |which was |]traveling {xb} [in the {lane}|on {road}]{appr}
{Vi} {xb} [in the {lane}|on {road}]{appr}
{Vi}[ and was|, which was|, and it was] [traveling|driving|heading|going] {dir} [in the {lane}|on {road}]{appr}
{Vi}. [It|This vehicle] was [traveling|going|heading] {dir} [in the {lane}|on {road}|in the {lane} of {road}]{appr}
{Vi} [moving|driving|proceeding|going] {dir} [in the {lane}|on {road}]{appr}
~{Vi} on its way {dir} [in the {lane}|on {road}]{appr}
"""),
    "stopped": clauses("""
{Vi} [that was |which was |]stopped {xb} [in the {lane}|on {road}]{why}
{Vi} stopped facing {dir} in the {lane}{why}
{Vi}. [It|This vehicle] was stopped [facing {dir} in the {lane}|{xb} in the {lane}|{xb} on {road}]{why}
{Vi} [and was|, which was] stopped [in the {lane}, facing {dir}|while {xb}]{why}
~{Vi} at a standstill in the {lane}, facing {dir}{why}
"""),
    "slowing": clauses("""
{Vi} traveling {dir} [in the {lane} |on {road} |]and [slowing|slowing down|decelerating]{why}
{Vi}. [It|This vehicle] was {xb} and [slowing|was slowing|decelerating]{why}
{Vi} [that was|which was] slowing [in the {lane} |]while {xb}{why}
~{Vi} {xb} and losing speed{why}
"""),
    "waiting": clauses("""
{Vi} [that was |]stopped {xb} [in the {lane} |]{why}
{Vi}. [It|This vehicle] was stopped [facing {dir}|{xb}|in the {lane}, facing {dir}]{why}
{Vi} traveling {dir} [in the {lane} |on {road} |]and [had stopped|stopped]{why}
~{Vi} facing {dir} and at rest{why}
"""),
}
"""After `V1 was a 2003 sedan`."""

APPROACH_SLOWING = clauses("""
{Vf} was traveling {dir} and [slowed down|reduced its speed|had slowed]{why}
The driver of {Vf}, {xb}, [applied the brakes|slowed the vehicle]{why}
{Vf} was traveling {dir} [in the {lane}|on {road}] and was [slowing|decelerating|slowing down|braking]{why}
{Vf} was {xb} [in the {lane} |]and [began to slow|slowed|was slowing]{why}
The driver of {Vf} was traveling {dir} [in the {lane}|on {road}] and [began to brake|was braking|began slowing]{why}
{Vf}, {xb} [in the {lane}|on {road}], [slowed|began to slow|braked|reduced speed]{why}
While [traveling|heading] {dir} [in the {lane}|on {road}], {Vf} [slowed|braked|decelerated|began to slow down]{why}
{Vf} was slowing [in the {lane} |]as it [traveled|headed] {dir}{why}
{Vf} [had begun slowing|was in the process of slowing] while traveling {dir}[ in the {lane}|]{why}
In the {lane}, {Vf} was [traveling|moving] {dir} and [decreasing its speed|coming to a stop|about to stop]{why}
{Vf} was [coming to a stop|in the process of stopping] [in the {lane} |]while {xb}{why}
{Vf} {xb} [in {lane}|on {road}], slowing{why}
The driver of {Vf} [reduced speed|let the vehicle slow|applied the brakes] while [driving|traveling] {dir}[ in the {lane}|]{why}
On {road}, {Vf} was {xb} and [slowing|decelerating|braking]{why}
~{Vf}, {xb}, was losing speed [in the {lane}|]{why}
""")

APPROACH_PARKED = clauses("""
{Vf} was [legally |]parked [on the right side of the road|along the right curb|on the right shoulder][, unoccupied,|] facing {dir}
{Vf} was parked and unoccupied[ on {road}|], facing {dir}
{Vf} was facing {dir} and was parked [at the roadside|on the shoulder|in front of a house|beside the road]
{Vf} was an unoccupied vehicle [legally |]parked facing {dir} on [the right side of the road|the right shoulder|{road}]
Facing {dir}, {Vf} was [legally parked|parked] [on the right side of {road}|along the right edge of the road|on the street]
The owner of {Vf} had parked [it|the vehicle] [along the right side of the road|on the right shoulder|in front of a house], facing {dir}
{Vf}, unoccupied, was parked [{xb}|facing {dir}] [on|along] {road}
{Vf} [was in|occupied] a parking space on the right side of {road} and faced {dir}
{Vf} parked unoccupied, facing {dir}[, right curb|]
There was no one in {Vf}, which was parked facing {dir} [on {road}|along the right curb]
~{Vf} had been left at the curb, facing {dir}
""")

APPROACH_CURVE = clauses("""
{Vf} was traveling {dir} [in the {lane}|on {road}] and was [negotiating|entering|exiting|rounding] a {curve} curve
{Vf} was [negotiating|rounding] a curve to the {curve} [while traveling|, heading|, going] {dir} [in the {lane}|on {road}]
{Vf} was [traveling|heading] {dir} [on {road}|in the {lane}] where the road[way|] [curves|curved] to the {curve}
While [negotiating|rounding|going around] a {curve} curve, {Vf} was [traveling|heading] {dir}[ in the {lane}|]
The driver of {Vf} was [negotiating|driving through|going around|steering through] a curve to the {curve}, [traveling {dir}|{xb}][ in the {lane}|]
{Vf} [entered|was going into|had entered] a {curve} curve while [traveling|heading] {dir}[ on {road}|]
{Vf}, {xb} in the {lane}, was [following|entering|coming out of] a curve to the {curve}
A {curve} curve was being negotiated by {Vf}, [which was |]traveling {dir}[ in the {lane}|]
{Vf} was {xb} and [negotiating|rounding|in the middle of] a [sweeping|sharp|gradual] curve to the {curve}[ on {road}|]
As the road[way|] curved {curve}, {Vf} was traveling {dir} [in the {lane}|on {road}]
{Vf} {xb} in {curve} curve[, {lane}|]
~{Vf}, {xb}, was in a {curve}-hand bend [of {road}|]
""")

WHY = tables(
    light="for a red light|at a red light|waiting for the light to change|for a red traffic signal|for the traffic signal|due to a red light|for the red signal phase|for the red light ahead|to wait for a green light|for a traffic light|because of a red traffic light|in response to a red signal|for the signal light, which was red|since the traffic light had turned red|as the light changed to red|in obedience to the red signal|for a red traffic control signal|~while the signal was red",
    sign="at the stop sign|for the stop sign|at a posted stop sign|as required by the stop sign|in obedience to the stop sign|to obey the stop sign|because of the stop sign|due to a stop sign|in compliance with the stop sign|~before the stop sign",
    traffic="for traffic ahead|in traffic|due to stopped traffic|for traffic|because traffic had backed up|for a vehicle ahead|because of congestion ahead|for slower traffic|due to heavy traffic|behind other stopped vehicles|because the traffic in front had stopped|for a stopped vehicle ahead|as traffic came to a halt|in response to traffic ahead|for a non-contact vehicle|due to congestion|because another vehicle had stopped ahead|to avoid a vehicle in front|~in a line of cars",
    turn_left="waiting to turn left|waiting to make a left turn|preparing to turn left|to make a left turn into a driveway|in order to turn left|for a left turn|to turn left|so that it could turn left|before turning left|to wait for a gap in order to turn left|as it waited for a gap to turn left|because its driver intended to turn left|in preparation for a left turn|while its driver waited to turn left|to allow oncoming traffic to pass before turning left|~with its left blinker on",
    turn_right="waiting to turn right|preparing to turn right|to make a right turn|in order to turn right|for a right turn|to turn right|to turn right into a driveway|before turning right|in preparation for a right turn|because its driver intended to turn right|while its driver waited to turn right|so that it could turn right|~with its right blinker on",
)

SAME = clauses("""
{Vf} was [directly |]behind {W} [in the {lane}|], [traveling {dir}|{xb}]
{Vf} followed {W} [in the same lane|in the {lane}]
{W} was followed by {Vf}[ in the {lane}|]
{Vf} was [also |]traveling {dir} [in the {lane}|on the same road[way|]] [directly |]behind {W}
{Vf} was {xb} [in the same lane|on the same roadway] [behind|following] {W}
{Vf} was following {W}[ {dir}| in the {lane}|]
{Vf} was traveling in the same direction behind {W}
{Vf} was [traveling|driving|proceeding] {dir}, [following|trailing] {W}
{Vf} was the [following|trailing|next] vehicle, {xb} behind {W}
{Vf} traveled {dir} [to the rear of|in back of|directly behind] {W}
The driver of {Vf} was following {W}[, {xb}| in the {lane}| in the same lane|]
The driver of {Vf} was [driving|traveling|proceeding] {dir} [directly |]behind {W}
{Vf}, [also |]{xb}, was [directly |]behind {W}[ in the {lane}|]
Following {W}, {Vf} was [also |]traveling {dir}[ in the {lane}|]
{W} was ahead of {Vf}, which was [also |]{xb}[ in the {lane}|]
{Vf} was [traveling|heading] {dir} in the {lane} with {W} [directly ahead|in front of it|ahead of it]
{W} preceded {Vf} [in the {lane}|on the same road|in the same lane]
{Vf}, which was following {W}, was traveling {dir}[ in the {lane}|]
{Vf} and {W} were both {xb} [in the same lane|on the same road|in the {lane}], with {W} in [front|the lead]
{Vf} had been following {W} [in the {lane}|for some distance|on the same road]
{Vf} {xb} [in {lane} |]behind {W}
{Vf} shared the {lane} with {W} and was [behind|following] it
{Vf} was traveling {dir} [a short distance|a few car lengths|several meters|closely] behind {W}
~{Vf} came up from behind {W}[ in the same lane|]
~Behind {W} was {Vf}[, also {xb}|]
""")

AHEAD = clauses("""
{Vf} was the [first|lead] vehicle, {xb} [in the {lane}|in front of {W}]
Ahead of {W}, {Vf} was traveling {dir}
{Vf} was [also |]{xb} [in the same lane|on the same roadway] [directly |]ahead of {W}
{Vf} was traveling {dir} ahead of {W}[ in the {lane}|]
{Vf} was [traveling|driving|proceeding] {dir} [in front of|directly ahead of] {W}
{Vf} led {W} [in the {lane}|in the same lane|on the same road]
{Vf} was being followed by {W} [in the {lane}|as both traveled {dir}]
{W} was behind {Vf}, which was [also |]traveling {dir}[ in the {lane}|]
{Vf} was the vehicle [ahead of|in front of] {W}, [also |]{xb}
{Vf}, [also |]{xb}, was [in front of|directly ahead of|ahead of] {W}[ in the {lane}|]
The driver of {Vf} was [driving|traveling] {dir} [in the {lane} |]ahead of {W}
{Vf} was in the {lane} [ahead of|in front of] {W}, traveling {dir}
{Vf} preceded {W} [in the {lane}|on the same road], {xb}
{Vf} {xb}[ in {lane}|], ahead of {W}
{Vf}, which was [in front of|ahead of] {W}, was traveling {dir}[ in the {lane}|]
{Vf} and {W} were [traveling|heading] {dir}, {W} [following|trailing|to the rear]
{Vf} had {W} [behind it|to its rear] as it traveled {dir}
~In front of {W} was {Vf}[, also {xb}|]
""")

INTENT = tables(
    straight="intending to go straight|intending on going straight|intending to travel straight through|going straight|planning to go straight|in order to go straight through|with the intention of going straight|proceeding straight ahead|intending to drive straight across|about to go straight through|expecting to pass straight through|to go straight|continuing straight ahead|with no intention of turning|~meaning to continue straight",
    turn_left="intending to turn left|intending on turning left|attempting to make a left turn|about to turn left|planning to turn left|in order to make a left turn|with the intention of turning left|preparing for a left turn|to make a left|getting ready to turn left|intending a left turn|where its driver planned to turn left|to turn left|~meaning to go left",
    turn_right="intending to turn right|intending on turning right|attempting a right turn|about to turn right|planning to turn right|in order to make a right turn|with the intention of turning right|preparing for a right turn|to make a right|getting ready to turn right|intending a right turn|where its driver planned to turn right|to turn right|~meaning to go right",
    u_turn="intending to make a U-turn|planning a U-turn|about to make a U-turn|attempting a U-turn|in order to make a U-turn|~wanting to turn around",
)

enlarge("motion", globals())
