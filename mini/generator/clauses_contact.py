# ruff: noqa: E501 - one clause a line
"""Clauses about avoidance, contact and rest. {S} strikes {T}; {sa} and {ta} are the areas that meet.

{V} {W} mention a vehicle, {anyside} and {any8} are noise.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

AVOID = clauses("""
The driver of {W} saw {V} and [braked|steered {anyside}|applied the brakes] [but it was too late|to avoid a collision]
{W} braked and left {m} meters of skid marks
The driver of {V} attempted to steer {anyside} but there was no time
There was no [evasive|avoidance] action by [the driver of {V}|either driver]
The driver of {W} [braked|steered {anyside}|braked and steered {anyside}|swerved to the {anyside}] but [was unable to|could not] avoid [contact|the collision|{V}]
The driver of {V} did not take any avoidance actions
Neither driver attempted any [evasive|avoidance] actions
{W} [braked|applied the brakes][ with lockup|] and steered {anyside}
~Hard braking by {W} did not help
~{W} swerved {anyside}
""")

IMPACT = clauses("""
The {sa} of {S} [slammed|crashed|drove|plowed] into the {ta} of {T}
{S} struck {T}, {sa} to {ta}
[Contact|The impact|The collision] was the {sa} of {S} to the {ta} of {T}
[As a result|Subsequently|At this point|Then], the {sa} of {S} [struck|contacted|hit] the {ta} of {T}
{S} contacted the {ta} of {T} with the {sa}
{S} hit the {ta} of {T}, damaging its own {sa}
{T} was struck by {S} on the {ta}, which damaged the {sa} of {S}
This caused the {sa} of {S} to [strike|contact|impact|hit] the {ta} of {T}
{T} received an impact to its {ta} from the {sa} of {S}
{T} was [struck|hit|contacted] by {S}, [{sa} to {ta}|with the {sa} of {S} against the {ta} of {T}]
{S}, unable to stop, [struck|hit] the {ta} of {T} with its {sa}
The {ta} of {T} was [damaged|hit|struck] when {S} contacted it with its {sa}
[The vehicles|Both vehicles] collided, the {sa} of {S} against the {ta} of {T}
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
The front of {S} struck the back of {T}
{S} drove into the rear of {T}
{S} could not stop and hit the back end of {T}
The back of {T} was struck by the front of {S}
{S} rear-ended {T}
{S} [struck|hit|impacted] {T} from behind
{T} was [rear-ended|struck from behind|hit from behind] by {S}
{S} collided with the back of {T}
~{S} ran into {T} from behind
~{T} was bumped from the rear by {S}
""")

IMPACT_BARE = clauses("""
{S} made contact with {T}
{S} then struck {T}
{S} and {T} [made contact|collided]
{S} [struck|hit|impacted|collided with] {T}
{T} was [struck|hit] by {S}
The vehicles collided
~{S} crashed into {T}
~{T} got hit by {S}
""")

SWIPE = clauses("""
{S} sideswiped {T}, {sa} to {ta}
The {ta} side of {T} was sideswiped by the {sa} side of {S}
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
    "front": "front|front|front|front|front end|frontal area|grille|frontal plane|leading edge|[left|right] front|front [left|right]|~nose|~front bumper",
    "back": "back|rear|rear|rear end|rear area|back bumper|rear plane|trunk|tailgate|back end|[left|right] rear|rear [left|right] corner|~tail|~rear bumper",
    "left": "left side|left side|left side|left front door|left rear quarter panel|left doors|left plane|left front fender|driver side doors|left side|left|driver's side|driver side|left front side|left-side|~left flank|~driver's door",
    "right": "right side|right side|right side|right front door|right rear quarter panel|right doors|right plane|right front fender|passenger side doors|right side|right|passenger side|passenger's side|right front side|right-side|~right flank|~passenger door",
}

REST = clauses("""
{V} traveled {any8} for {m} meters before it came to rest
{V} came to rest on [its wheels|its roof|its right side|its left side] [in the road|off the road|]
{V} was pushed {any8} into [the curb|a pole|a ditch|the median]
From impact {V} [slid|rolled|went] {any8} and stopped [facing {any8b}|]
Both vehicles remained in contact and moved {any8}
{V} [rotated|spun] [clockwise|counterclockwise|counter-clockwise][ {deg} degrees|] and came to [rest|final rest] [in the intersection|off the roadway|on the roadway|in the road][ facing {any8}|]
Both vehicles came to [rest|final rest] [in the intersection|near impact|on the roadway|off the road][ facing {any8}|]
{V} came to [rest|final rest] facing {any8}[; {W} came to final rest facing {any8b}|]
{V} continued {any8} and came to rest [{m}m|{m} meters|{m} feet] {any8b} of impact
The impact caused {V} to [rotate|spin] [clockwise|counterclockwise] and [depart the road|come to rest facing {any8}]
There was no physical evidence to [support|substantiate] the final rest positions
{V} was pushed [off the road|into the next lane|into a driveway] before coming to rest
~After that {V} rolled to a stop facing {any8}
""")
