# ruff: noqa: E501 - one clause a line
"""Clauses about avoidance, contact and rest. {S} strikes {T}; {sa} and {ta} are the areas that meet.

{V} {W} mention a vehicle, {anyside} and {any8} are noise.
"""

from __future__ import annotations

from mini.generator.further import enlarge
from mini.generator.grammar import clauses, tables

AVOID = clauses("""
{V} took evasive [action|maneuvers] by [braking|steering {anyside}|braking and steering {anyside}]
The driver of {V} [attempted|tried] to brake and steer {anyside}, leaving {m} meters of skid marks
[Before impact|Prior to impact], the driver of {W} [braked|swerved {anyside}|applied the brakes]
No evasive [action|maneuver] was taken by [the driver of {V}|{V}|either driver]
The driver of {W} had no time to [react|brake|take evasive action]
The brakes of {V} were applied [hard |]but it [skidded|slid] [on|forward]
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
{S} [ran|crashed|slid|skidded|continued] into the {ta} of {T} with its {sa}
{S} crashed into {T}, {sa} [in|]to {ta}
{S}'s {sa} [crashed|slammed|ran|plowed] into {T}'s {ta}
The {ta} of {T} was [run into|crashed into|rammed] by the {sa} of {S}
{T} [sustained|suffered] [an impact|a hit|damage] to the {ta} [from|by] {S}, which was damaged on the {sa}
{S} impacted {T} at the {ta}; {S}'s damage was to its {sa}
{S} was damaged at the {sa} when it [hit|struck|ran into] the {ta} of {T}
{T} was damaged at the {ta} when {S} [hit|struck|ran into] it with the {sa}
In the [collision|crash|impact], {S} struck {T} in the {ta} with the {sa}
At impact the {sa} of {S} [engaged|hit] the {ta} of {T}
{S} went into the {ta} of {T}, {sa} first
It was the {sa} of {S} that [struck|hit|contacted] the {ta} of {T}
What {S} [hit|struck] with its {sa} was the {ta} of {T}
{T} could not get away and was [hit|struck] [in|on] the {ta} by the {sa} of {S}
{S} did not stop and its {sa} [hit|struck|reached] the {ta} of {T}
{T} had its {ta} [struck|hit|damaged|crushed] by the {sa} of {S}
The driver of {S} [struck|hit] the {ta} of {T} with the {sa} of [his|her|the] vehicle
The driver of {T} was [struck|hit] [in|on] the {ta} of [his|her] vehicle by the {sa} of {S}
The [first|initial|primary] [impact|contact|event] [involved|was] the {sa} of {S} [striking|hitting|contacting] the {ta} of {T}
{T}, [while still moving|which could not avoid it|unable to get clear], was [struck|hit] by the {sa} of {S} [in|on] its {ta}
{S} [bumped|clipped|rammed|tapped] the {ta} of {T} with its {sa}
The {sa} of {S} [bumped|clipped|rammed|hit] {T} [in|on|at] the {ta}
The impact to {T} was to the {ta} and came from the {sa} of {S}
{T}'s {ta} [sustained|received] the impact of {S}'s {sa}
The {ta} of {T} came into contact with the {sa} of {S} as {S} [struck|hit] it
{S} [struck|hit] {T}. [The impact was|Contact was] {sa} to {ta}
{T} was [struck|hit] by {S}. The {ta} of {T} was damaged by the {sa} of {S}
[Striking|Hitting] the {ta} of {T}, {S} was damaged on its {sa}
[Struck|Hit] [in|on] the {ta} by the {sa} of {S}, {T} [spun|was pushed aside|was pushed {any8}]
{S} and {T} [collided|crashed]; the {sa} of {S} [hit|struck] the {ta} of {T}
{S} and {T} [collided|crashed]; {T} was [hit|struck] [in|on] the {ta} by the {sa} of {S}
The {ta} of {T} [is|was] [impacted|struck] by {S}'s {sa}
The {sa} of {S} [impacts|strikes|contacts] the {ta} of {T}
{T} could not get out of the way and its {ta} was [struck|hit] by {S} with the {sa}
The collision [left|caused] damage to the {sa} of {S}, which struck, and to the {ta} of {T}, which was struck
{S} impacted with the {ta} of {T}, with [its|it's] {sa}
{S}, which could not stop, [struck|impacted] {T} [in|on] the {ta} with its {sa}
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
The {sa} of {S} [struck|impacted|struck] the {ta} of {T}[ in a [T|L]-type configuration||]
{S} [struck|hit|impacted|contacted] {T} [in|on] the {ta} with its {sa}
{S}'s {sa} [struck|impacted|contacted|hit] {T}'s {ta}
{S}'s {sa} [struck|impacted|made contact with] the {ta} of {T}
{T} was [struck|hit|impacted|struck] [in|on] the {ta} by the {sa} of {S}
{T}'s {ta} was [struck|contacted|impacted] by [the {sa} of {S}|{S}'s {sa}]
The {ta} of {T} was [struck|hit|impacted|contacted] by the {sa} of {S}
The {sa} of {S} [and the {ta} of {T} made contact|[came into contact with|contacted] the {ta} of {T}]
{S} [struck|impacted] the {ta} of {T} with [its|it's] {sa}
{T} [was then|was] [struck|contacted] [in|on] its {ta} by {S} with its {sa}
~Contact was made between the {sa} of {S} and the {ta} of {T}
~{T} took the {sa} of {S} in its {ta}
~The {ta} of {T} met the {sa} of {S}
~With its {sa}, {S} ran into the {ta} of {T}
~Into the {ta} of {T} went the {sa} of {S}
""")

IMPACT_REAR = clauses("""
{S} [bumped|tapped|rammed|slammed into|crashed into] the [back|rear] [end |]of {T}
{T} was [bumped|pushed|rammed] from behind by {S}
The [rear|back] [end |]of {T} was [hit|struck|impacted] by {S}
{S}, [coming up behind|following too closely|unable to stop], [struck|hit] the rear of {T}
The front [end |]of {S} [hit|struck|impacted|contacted] {T} [in|on] the [rear|back]
{S} [came into|made] contact with the rear [end |bumper |]of {T}
{S} struck {T} in the [rear|back] with its front
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
{S} ran into {T}
The two vehicles [crashed|made contact]
{T} was [rammed|bumped] by {S}
{S} [impacted|bumped|rammed] {T}
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
{S}'s {sa} side [scraped|rubbed|brushed] {T}'s {ta} side
{T} was sideswiped by {S}; the {sa} side of {S} was against the {ta} side of {T}
{S} side-swiped {T} [along|on] the {ta} side with its {sa} side
The vehicles sideswiped, {sa} side of {S} to {ta} side of {T}
The {ta} [side |]of {T} was [struck|contacted] by the {sa} [side |]of {S}
{S} sideswiped {T}, {sa} to {ta}
The {ta} side of {T} was sideswiped by the {sa} side of {S}
{S} and {T} sideswiped, {S}'s {sa} [side |]against {T}'s {ta} side
The {sa} [side |]of {S} sideswiped the {ta} side of {T}
The {sa} [side |]of {S} [struck|contacted|made contact with] the {ta} side of {T}
~{S} scraped its {sa} side along the {ta} side of {T}
""")

LEADS = [
    "Moments later", "Seconds later", "As it did so", "Before either driver could react", "With no time to stop", "During this maneuver", "At the point of impact",
    "Shortly thereafter", "In the process", "Then", "While both were still moving", "A moment later", "Consequently", "According to both drivers",
]  # fmt: skip
TAILS = [
    " and both vehicles spun", ", pushing it to the {any8}", " at an angle", " at moderate speed", " near the middle of the road", " before either could stop",
    ", and both drivers were surprised", ", causing damage to both", " with great force", ", after which both stopped",
]  # fmt: skip
"""What may stand before and behind what a clause tells of a contact; never in held-out narratives."""

THEN = clauses("""
{S} [then|subsequently] [ran|crashed] into the {ta} of {T} with its {sa}
The {ta} of {T} was then [struck|hit] by the {sa} of {S}
After this, {S} [struck|hit] {T}, {sa} to {ta}
[As a result|From the impact], {S} was forced into {T}, its {sa} striking the {ta} of {T}
The {sa} of {S} then [struck|impacted|contacted] the {ta} of {T}
{T} was then [struck|hit] [in|on] the {ta} by the {sa} of {S}
{S} was pushed [forward |]and its {sa} [struck|contacted] the {ta} of {T}
~Next, {S} ran its {sa} into the {ta} of {T}
""")
THEN_REAR = clauses("""
{S} then [rear-ended|ran into the back of|struck the rear of] {T}
{T} was then [struck|hit] from behind by {S}
The impact [pushed|forced|drove] {S} into the [rear|back] of {T}
{S} was pushed [forward |]into [the rear of |the back of |]{T}
The front of {S} then [struck|impacted] the [rear|back] of {T}
~This knocked {S} into the vehicle in front of it, {T}
""")

AREA = tables(
    front="front|front|front|front|front end|frontal area|grille|frontal plane|leading edge|[left|right] front|front [left|right]|front portion|front side|front grill|frontal portion|hood|[left|right] headlight|[left|right] front corner|front [left|right] corner|~nose|~front bumper",
    back="back|rear|rear|rear end|rear area|back bumper|rear plane|trunk|tailgate|back end|[left|right] rear|rear [left|right] corner|back side|back portion|[left|right] taillight|rear hatch|[left|right] rear corner|rear portion|rear plane|back side|~tail|~rear bumper",
    left="left side|left side|left side|left front door|left rear quarter panel|left doors|left plane|left front fender|driver side doors|left side|left|driver's side|driver side|left front side|left-side|left rear door|left front wheel|left rear wheel|left rear side|left side doors|left mid-section|left quarter panel|left rear fender|driver side|left side of the body|~left flank|~driver's door",
    right="right side|right side|right side|right front door|right rear quarter panel|right doors|right plane|right front fender|passenger side doors|right side|right|passenger side|passenger's side|right front side|right-side|right rear door|right front wheel|right rear wheel|right rear side|right side doors|right mid-section|right quarter panel|right rear fender|passenger side|right side of the body|~right flank|~passenger door",
)

REST = clauses("""
{V} [stopped|ended up] [in the roadway|on the shoulder|in a ditch|at the {anyside} edge of the road][ facing {any8}|]
{V}'s final rest was facing {any8}[ against a pole| in the ditch|]
{V} rolled over [one|two|three] quarter turns onto its [top|{anyside} side]
The final rest [position|location] of {V} was [in the intersection|off the road|{m} meters {any8} of impact]
{V} and {W} [stayed together|separated] and came to rest facing {any8}
After [the impact|impact|the collision], {V} [was thrown|was carried|moved] {any8}[ and stopped|]
{V} [departed|left] the road[way|] on the {any8} side [and struck a [pole|fence|sign]|]
Both vehicles [spun|rotated] and [stopped|came to rest] [in the road|facing {any8}|off the road]
{V} traveled {any8} for {m} meters before it came to rest
{V} came to rest on [its wheels|its roof|its right side|its left side] [in the road|off the road|]
{V} was pushed {any8} into [the curb|a pole|a ditch|the median]
From impact {V} [slid|rolled|went] {any8} and stopped [facing {any8b}|]
Both vehicles remained in contact and moved {any8}
{V} [rotated|spun] [clockwise|counterclockwise|counter-clockwise][ {deg} degrees|] and came to [rest|final rest] [in the intersection|off the roadway|on the roadway|in the road][ facing {any8}|]
Both vehicles came to [rest|final rest] [in the intersection|near impact|on the roadway|off the road][ facing {any8}|]
{V} came to [rest|final rest] facing {any8}[; {W} came to final rest facing {any8b}|]
{V} came to rest [{m}m|{m} meters|{m} feet] {any8} of impact
The impact caused {V} to [rotate|spin] [clockwise|counterclockwise] and [depart the road|come to rest facing {any8}]
There was no physical evidence to [support|substantiate] the final rest positions
{V} was pushed [off the road|into the next lane|into a driveway] before coming to rest
~After that {V} rolled to a stop facing {any8}
""")

enlarge("contact", globals())
