# ruff: noqa: E501 - one clause a line
"""What investigators code and drivers state of the crash itself: true of it, unlike the noise around them.

Keys are what a vehicle did or met (`mini.generator.blocks.event_of`); {code} is a phrase of EVENT, {move} one of
MOVEMENT, {kind} one of CRASH_TYPE. {V} is coded or speaks, {W} is the other.
"""

from __future__ import annotations

from mini.generator.further import enlarge
from mini.generator.grammar import clauses, tables

EVENT_FRAMES = clauses("""
The Critical [Precrash|Pre-crash|Pre-Crash] Event for {V} was {code}
The critical [precrash|pre-crash] event for {V} was [coded |][as |]{code}
The Critical [Precrash|Pre-crash] Event [coded|assigned] [for|to] {V} was {code}
The Critical [Precrash|Pre-crash] Event for {V} was coded as[:|] {code}
The critical event for {V} was [coded as |]{code}
{V} was [coded|assigned] the critical [precrash |pre-crash |]event of {code}
For {V}, the critical [precrash |pre-crash |]event was [coded as |]{code}
The critical [precrash|pre-crash] event for {V} was when [{code}|the following happened: {code}]
The critical [precrash|pre-crash] event [to|for] this vehicle was [coded as |]{code}
{V} was coded with the critical event: {code}
This vehicle was coded with the critical event: {code}
Coded as the critical event for {V} was {code}
[Critical event|Critical precrash event], {V}: {code}
[The researcher|The investigator] coded the critical event for {V} as {code}
The event that made the crash imminent for {V} was [coded as |]{code}
The critical precrash category for {V} was {code}
~The code for what made this crash critical to {V} reads {code}
~{V} has {code} as its critical event
""")

EVENT = tables(
    turn_left="this vehicle traveling, turning left at intersection|this vehicle traveling and turning left at the intersection|turning left at intersection|turning left|this vehicle traveling: turning left at junction|this vehicle turning left at an intersection|this vehicle was turning left|a left turn by this vehicle|this vehicle initiated a left turn|turned left|~turning to its left",
    turn_right="this vehicle traveling, turning right at intersection|this vehicle traveling and turning right at the intersection|turning right at intersection|turning right|this vehicle turning right at an intersection|this vehicle was turning right|a right turn by this vehicle|this vehicle initiated a right turn|~turning to its right",
    crossing="this vehicle traveling, crossing over (passing through) intersection|this vehicle traveling and crossing over the intersection|crossing over, passing through intersection|crossing over the intersection|passing through the intersection|this vehicle crossing over an intersection|this vehicle passing straight through the intersection|~going across the junction",
    over_left="this vehicle traveling over the lane line on the left side of the travel lane|this vehicle traveling, over the lane line on left side of travel lane|traveling over the left lane line|over the lane line on left side of travel lane|this vehicle crossing the left lane line|this vehicle over the left lane line|~leaving its lane by the left",
    over_right="this vehicle traveling over the lane line on the right side of the travel lane|this vehicle traveling, over the lane line on right side of travel lane|traveling over the right lane line|over the lane line on right side of travel lane|this vehicle crossing the right lane line|~leaving its lane by the right",
    off_left="this vehicle traveling off the edge of the road on the left side|off the edge of the road on the left side|this vehicle departing the left edge of the roadway|traveling off the left edge of the road|~going over the left edge",
    off_right="this vehicle traveling off the edge of the road on the right side|off the edge of the road on the right side|this vehicle departing the right edge of the roadway|traveling off the right edge of the road|~going over the right edge",
    into_stopped="other motor vehicle in lane, other vehicle stopped|other vehicle in lane, stopped|other vehicle stopped|the other vehicle was stopped in the lane|another vehicle in lane: stopped|other motor vehicle in the lane stopped|~a halted vehicle in its lane",
    into_slowing="other motor vehicle in lane, traveling in same direction while decelerating|other vehicle in lane decelerating|other motor vehicle in the lane traveling in the same direction while decelerating|another vehicle ahead, decelerating|other vehicle in lane, slowing|~a slowing vehicle in its lane",
    into_slower="other motor vehicle in lane, traveling in same direction with lower steady speed|other vehicle in lane with a lower speed|other motor vehicle in the lane traveling in the same direction at a lower speed|~a slower vehicle in its lane",
    turn_around="this vehicle traveling, making a U-turn|this vehicle making a U-turn|a U-turn by this vehicle|~turning back",
    backing="this vehicle backing|this vehicle traveling, backing|this vehicle backing from a driveway|~moving in reverse",
    from_opposite="other vehicle encroachment from opposite direction, over left lane line|other vehicle encroachment from opposite direction over left lane line|another vehicle encroaching from the opposite direction over the left lane line|encroachment of another vehicle from the opposite direction|other vehicle encroaching, from opposite direction|the encroachment of {W} from the opposite direction over the left lane line|other vehicle encroached into lane from opposite direction|~an oncoming vehicle in its lane",
    from_crossing="other vehicle encroachment from crossing street, across path|other vehicle encroaching into lane from crossing street, across path|another vehicle encroaching from a crossing street across the path|encroachment by {W} from the crossing street, across the path of this vehicle|other vehicle encroachment, from crossing street across path|other vehicle from crossing street, across path|~a vehicle from the cross street in its path",
    from_side_left="other vehicle encroachment from crossing street, turning into opposite direction|other vehicle encroachment from crossing street, across path|another vehicle from a crossing street turning into the opposite direction|other vehicle encroachment, from crossing street, turning left|encroachment of {W} from the crossing street|~a vehicle from the side turning left",
    from_side_right="other vehicle encroachment from crossing street, turning into same direction|another vehicle from a crossing street turning into the same direction|other vehicle encroachment, from crossing street, turning right|encroachment of {W} from the crossing street, turning into the same direction|~a vehicle from the side turning right",
    from_driveway="other vehicle encroachment from driveway, alley access, etc., across path|other vehicle encroachment from driveway, across path|another vehicle encroaching from a driveway|encroachment of {W} from a driveway|~a vehicle from a drive in its path",
    from_behind="other motor vehicle in lane traveling in same direction with higher speed|other vehicle in lane, traveling in the same direction with higher speed|other motor vehicle in lane traveling in the same direction at a higher speed|another vehicle in lane with a higher speed|~a faster vehicle behind it",
    from_left_lane="other vehicle encroachment from adjacent lane (same direction), over left lane line|other vehicle encroachment from adjacent lane, same direction, over left lane line|another vehicle encroaching from the adjacent lane over the left lane line|~a vehicle from the lane at its left",
    from_right_lane="other vehicle encroachment from adjacent lane (same direction), over right lane line|other vehicle encroachment from adjacent lane, same direction, over right lane line|another vehicle encroaching from the adjacent lane over the right lane line|~a vehicle from the lane at its right",
    pedestrian="pedestrian in roadway|pedestrian, pedalcyclist or other nonmotorist in roadway|a nonmotorist in the roadway|~someone on foot in the road",
)

MOVEMENT_FRAMES = clauses("""
The [pre-event|pre-crash|precrash] movement of {V} was [coded as |]{move}
The [pre-event|pre-impact] movement for {V} was {move}
[Pre-event|Pre-impact] movement of {V}: {move}
{V} was [coded as|coded with] {move} prior to the critical event
Prior to the critical event, {V} was {move}
The [researcher|investigator] coded {V} as {move} before the event
~Before it became critical {V} had been {move}
""")

MOVEMENT = tables(
    straight="going straight|going straight|proceeding straight|traveling straight",
    negotiating_curve="negotiating a curve|negotiating a curve",
    turn_left="turning left|making a left turn|in a left turn",
    turn_right="turning right|making a right turn|in a right turn",
    stopped="stopped in traffic lane|stopped in the traffic lane|stopped",
    slowing="decelerating in traffic lane|decelerating|slowing in the traffic lane",
    lane_change_left="changing lanes|changing lanes to the left",
    lane_change_right="changing lanes|changing lanes to the right",
    merge="merging|entering the highway from a ramp",
    overtaking="passing or overtaking another vehicle|passing another vehicle|overtaking",
    u_turn="making a U-turn|turning around",
    backing="backing up|backing",
)
"""Of maneuvers that are also what is coded; who left a lane or the road had been going straight or around a curve."""

TYPE_FRAMES = clauses("""
The crash type [of|for] {V} was [coded as |]{kind}
{V} was coded with the crash type {kind}
[Crash type|Accident type]: {kind}
This [crash|event] was [classified|coded] as {kind}
~By its configuration this counts as {kind}
""")

CRASH_TYPE = tables(
    crossing="straight paths, intersecting|intersecting paths, both going straight|intersecting straight paths",
    left_opposite="turn across path, initial opposite directions|a left turn across the path of an oncoming vehicle|turn across path from the opposite direction",
    left_lateral="turn into path, from the side|changing trafficway, turning left|intersecting paths, turning left",
    right_into="turn into same direction|changing trafficway, turning right|turn into path, same direction",
    rear_end="rear-end, same direction|same trafficway, same direction, rear-end|a rear-end crash",
    head_on="same trafficway, opposite direction|head-on, opposite directions|opposite direction, lateral move",
    lane_change="sideswipe or angle, same direction|same trafficway, same direction, lane change|a lane change crash",
    departure="single driver, roadside departure|a single-vehicle road departure|roadside departure",
    backing="backing into the path of another vehicle|a backing crash",
    merge="same direction, merging|a merge crash",
    overtaking="same trafficway, opposite direction, passing|a passing crash",
    u_turn="turn across path, U-turn|a U-turn crash",
    pedestrian="pedestrian in road|a crash with a nonmotorist",
)

SELF_FRAMES = clauses("""
{He} [stated|said|reported|indicated|advised] that {he} was {doing}[ and did not see {W}| when the crash occurred| prior to the crash| when {he} saw {W}|]
The driver of {V} [stated|said|told police|reported] that {he} was {doing}[ and never saw {W}| at the time| before the crash|]
{He} was {doing} [when|and] {he} [noticed|saw] {W}[ too late|]
According to the driver of {V}, {he} was {doing}[ when {W} appeared|]
The driver said {he} had been {doing}
{He} told the [officer|investigator|researcher] {he} was {doing} [at the time|when the crash happened]
[During the interview|When interviewed], the driver of {V} [stated|said] {he} was {doing}
While {doing}, {he} [did not notice|failed to see|never saw] {W}
{He} stated {he} had [stopped|looked both ways] and then was {doing}
~As {he} tells it, {he} was {doing}
""")

DOING = tables(
    straight="going straight|traveling {xb}|driving {dir}|going straight {xb}|traveling {dir} in the {lane}|proceeding straight|driving straight ahead",
    negotiating_curve="negotiating the curve|going around the curve|traveling {dir} in the curve|driving through the curve",
    turn_left="turning left|making a left turn|making a left-hand turn|trying to turn left|in the process of turning left|attempting to turn left|starting a left turn|pulling out to turn left",
    turn_right="turning right|making a right turn|making a right-hand turn|trying to turn right|in the process of turning right|attempting to turn right",
    stopped="stopped|stopped in traffic|sitting in traffic|stopped and waiting|at a complete stop",
    slowing="slowing|slowing for traffic|braking|slowing down",
    lane_change_left="changing lanes to the left|moving to the left lane|changing into the left lane",
    lane_change_right="changing lanes to the right|moving to the right lane|changing into the right lane",
    merge="merging|merging onto the highway|entering from the ramp",
    overtaking="passing a slower vehicle|overtaking another vehicle|passing on the left",
    u_turn="making a U-turn|turning around|trying to make a U-turn",
    backing="backing|backing out|backing out of a driveway",
)

OTHER_FRAMES = clauses("""
{He} [stated|said|reported|indicated|advised] that {W} {did}
The driver of {V} [stated|said|told police|reported] that {W} {did}
{He} [saw|noticed|observed] that {W} {did} but [could not stop|had no time to react|could not avoid it]
According to the driver of {V}, {W} {did}
{He} [swerved|braked|steered {anyside}] when {W} {did}
When {W} {did}, {he} [applied the brakes|had no time to react|tried to steer {anyside}|could not stop]
A witness [stated|said|reported] that {W} {did}
{He} was [going|traveling] {spd} when {W} {did}
{He} was [traveling|driving] {dir} [in the {lane} |]when {W} {did}
The driver told [police|the researcher|the officer] that {W} {did}
~In {his} telling {W} {did}
""")

DID = tables(
    turn_left="turned left in front of {his} vehicle|made a left turn in front of {his} vehicle|turned left into {his} path|turned left across {his} path|started to turn left|made a left turn without yielding|pulled out and turned left",
    turn_right="turned right in front of {his} vehicle|made a right turn into {his} path|turned right without stopping|pulled out and turned right",
    crossing="drove straight into the intersection|went through the intersection without stopping|crossed in front of {his} vehicle|drove into {his} path from the side|entered the intersection from the cross street",
    crossing_centerline="crossed the center line|came across the center line|came into {his} lane|was on the wrong side of the road|drifted across the center line",
    stopped="was stopped|was stopped ahead|had stopped in front of {his} vehicle|stopped suddenly",
    slowing="slowed|slowed suddenly|was slowing ahead|braked in front of {his} vehicle",
    lane_change_left="changed lanes to the left|moved left into {his} lane|came into {his} lane from the right",
    lane_change_right="changed lanes to the right|moved right into {his} lane|came into {his} lane from the left",
    merge="merged into {his} lane|came from the ramp into {his} lane",
    overtaking="was passing another vehicle|came toward {his} vehicle while passing|was overtaking",
    u_turn="made a U-turn in front of {his} vehicle|was making a U-turn|started to turn around",
    backing="backed out in front of {his} vehicle|was backing|backed into {his} path",
)

enlarge("codes", globals())
