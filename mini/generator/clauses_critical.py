# ruff: noqa: E501 - one clause a line
"""Clauses about the error that led to the crash, by configuration: {V} errs, {W} is the other.

{turn} left or right, {opp} the heading of oncoming traffic; {anyside} is noise.
"""

from __future__ import annotations

from mini.generator.clauses_turning import TURNING
from mini.generator.further import enlarge
from mini.generator.grammar import clauses

CRITICAL = TURNING | {
    "rear_end": clauses("""
{V} approached {W} from the rear
The driver of {V} looked [away|down|to the {anyside}] and did not [see|notice] that {W} had stopped
Traffic slowed and {V} was following too closely
{V} was going too fast to stop behind {W}
The driver of {V} braked but could not avoid {W}
The driver of {V} [did not see|failed to notice] {W} [stopped|slowing] ahead
{V} [did not slow|was unable to stop in time|failed to stop|could not stop]
{W} [slowed|was stopped] and {V} [did not|failed to slow]
{V} closed on {W} from [behind|the rear]
The driver of {V} was following [too closely|too close] to [stop|avoid {W}]
The distance between {V} and {W} was too short for {V} to stop
Because [of its speed|it was following too closely|its driver was inattentive], {V} could not stop behind {W}
{V} was unable to [stop|slow] [in time |]behind {W}
The driver of {V} [realized|noticed] too late that {W} [was slowing|had slowed|was stopping]
When [traffic ahead|the traffic in front] [slowed|stopped], {V} [kept going|continued ahead|did not stop]
{V} continued [ahead|forward|straight|at the same speed] toward the [rear|back] of {W}
The brakes of {V} were applied too late[ to avoid {W}|]
The driver of {V} was [distracted|looking at a cell phone|inattentive|looking elsewhere] and did not [react to|see] {W} ahead
[Distracted|Inattentive|Looking {anyside}], the driver of {V} did not see {W} [slowing|braking|ahead]
{V} skidded [forward |]toward the [rear|back] of {W}
The rear of {W} was approached by {V}, which [did not slow|was going too fast|failed to stop]
The driver of {V} [reached for|was adjusting|dropped] [a cell phone|the radio|a drink] and [failed to stop|did not see {W} ahead|did not notice the traffic ahead]
{V} following too closely[, failed to stop| behind {W}]
Despite braking, {V} could not [stop behind|be stopped short of] {W}
{W} [braked|slowed] [suddenly|for traffic] and {V} was [unable|not able] to stop in time
While following {W}, {V} [failed to stop|did not react in time|was unable to stop]
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
{V} [moved|slid|came] across the [center line|centerline|yellow line] into the path of {W}
The [center line|centerline|double yellow line] was crossed by {V}[, which entered the {opp} lane|]
The driver of {V} [overcorrected|oversteered|steered too far to the left] and [crossed the center line|went into the {opp} lane|entered the opposing lane]
[After drifting|After sliding|Sliding] to the left, {V} [entered|moved into] the {opp} lane
[Losing traction|For unknown reasons|Without warning], {V} crossed [over |]the [center line|centerline]
{V} encroached [into|on|upon] the {opp} [lane|travel lane][ in front of {W}|]
{V} was [left of center|over the center line|on the wrong side of the road|in the wrong lane] [when|as] {W} approached
The driver of {V} [dozed off|was distracted|became drowsy|swerved], and the vehicle [crossed the centerline|went left of center|moved into the {opp} lane]
{V}, out of control, [slid|rotated|skidded] across the center line into the {opp} lane
{V} departed [its|the] [original |]travel lane [over the left lane line|to the left] into the path of {W}
{V} [traveled|drove|went] across the [double yellow line|center line] and [met|faced] {W} in its lane
As {W} approached, {V} [came over|crossed|moved over] the [centerline|center line]
The {opp} lane was entered by {V} [as {W} approached|in front of {W}|]
{W} was in its own lane when {V} [crossed the center line|came left of center|crossed over]
{V} failed to [maintain its lane|stay in its lane|keep right] and [crossed the center line|entered the {opp} lane]
{V} crossed left of center[, {W} oncoming|]
{V} had [crossed|gone over|moved over] the center line and was [partly|entirely|completely] in the {opp} lane
The driver of {V}, who had [fallen asleep|lost control|lost consciousness], crossed [over |]the [centerline|center line]
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
{V} [initiated|started|made|was making] a lane change to the {turn}
A lane change to the {turn} was [attempted|started|made] by {V}
While changing lanes to the {turn}, {V} [encroached on the lane of|entered the lane of|did not see] {W}
The driver of {V} [decided|wanted|intended] to change lanes and [steered|moved|turned the wheel] to the {turn}
{V} [crossed|drifted over|moved across] the {turn} lane line [into the lane of|toward] {W}
{V} encroached [into|on] the adjacent {turn} lane[, occupied by {W}|]
The driver of {V} [checked the mirrors|looked in the mirror|signaled], did not see {W}, and [moved|steered|changed lanes] to the {turn}
{W} was [alongside|beside {V}|in the adjacent lane] when {V} [changed lanes|moved|steered] to the {turn}
To [pass a slower vehicle|avoid stopped traffic|reach an exit], {V} [moved|changed lanes|steered] to the {turn}
In changing lanes to the {turn}, {V} failed to yield to {W}
{V} [swerved|veered|drifted] {turn} [into|toward] the [adjacent lane|next lane|lane of {W}]
{V} changing lanes to {turn}[, did not see {W}|]
{V}, changing lanes to the {turn}, did not [leave room for|yield to] {W}
Not seeing {W}, the driver of {V} [merged|moved|changed lanes] to the {turn}
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
{V} [went|ran|veered] off the road[way|] to the {turn}
The {turn} [road edge|edge of the road|edge line] was crossed by {V}
[After a loss of control|For unknown reasons|Out of control], {V} [ran|went|traveled] off the road[way|] to the {turn}
The driver of {V} [fell asleep|swerved to avoid an animal|overcorrected|was distracted], and the vehicle [departed|ran off] the {turn} side of the road
{V} [crossed|drifted across|traveled over] the {turn} [fog line|edge line|shoulder] and [left the road|departed the roadway|entered the roadside]
{V}, [sliding|skidding|drifting] to the {turn}, [departed|left|ran off] the road[way|]
Departing the road[way|] to the {turn}, {V} [traveled onto the roadside|entered the grass|went onto the shoulder]
The vehicle [traveled onto|crossed] the {turn} [shoulder|roadside] and [left|departed] the road[way|]
The road[way|] was departed on the {turn} side by {V}
The driver of {V} steered too far to the {turn} and [left|ran off|departed] the road[way|]
[Reaching for a cell phone|Looking down|Reaching for a drink], the driver of {V} let the vehicle [drift|run|go] off the {turn} side of the road[way|]
{V} [rotated|spun|yawed] and [slid|skidded] off the {turn} [side|edge] of the road[way|]
{V} exited the road[way|] [to the {turn}|over the {turn} side|past the {turn} edge]
{V} ran off road {turn}[, driver lost control|]
{V} had [departed|gone off] the road[way|] to the {turn} after the driver lost control
~{V} left the pavement on the {turn}
"""),
    "pedestrian": clauses("""
{W} was crossing the road[way|] [in front of {V}|from the {side0}|]
{W} entered the road[way|] [from the {side0}|] [into the path|in front] of {V}
{W} [started|attempted|tried] to cross the road[way|] [in front of|ahead of] {V}
{W} [went|moved|came] [from the {side0}|from between parked cars] into the path of {V}
The driver of {V} [did not see|saw too late|failed to notice] {W} [crossing the road[way|]|in the road[way|]|in the crosswalk]
As {V} approached, {W} [crossed|was crossing|entered] the [road|roadway|street]
{V} [was going|continued] straight [as|when|while] {W} [crossed|was crossing|entered] the road[way|]
The path of {V} was crossed by {W}[ from the {side0}|]
{W}, crossing from the {side0}, [moved into|entered] the lane of {V}
{W} was in the [crosswalk|road[way|]|travel lane] when {V} approached
{W} entered roadway[ from {side0}|], {V} going straight
~{W} stepped out ahead of {V}
"""),
    "parked": clauses("""
{V} [drifted to the right|failed to notice the parked vehicle|moved to the right]
The driver of {V} did not [see|notice] {W} [parked ahead|parked along the road|at the side of the road]
{V} [veered|steered|drifted] [right|to the right], toward {W}
[While looking down|Distracted|Looking away], the driver of {V} [drifted|moved] to the right
{V} was too far to the right[ in its lane|]
{V} did not [leave|allow] enough room to [pass|clear] {W}
~{V} came too close to the curb
"""),
    "merge": clauses("""
{V} was entering from the ramp and moved into the lane of {W}
The driver of {V} was merging and did not see {W}
{V} [attempted to merge|merged|was merging] [into traffic|onto the highway|into the lane of {W}|from the ramp]
{V} came [down|off] the [entrance ramp|ramp|on-ramp] and [merged|moved|attempted to merge] into the lane of {W}
While merging [onto the highway|from the ramp|into traffic], {V} [did not yield to|entered the lane of|moved in front of] {W}
At the end of the [ramp|acceleration lane|entrance ramp], {V} merged [to the left|into the through lane|in front of {W}]
The driver of {V} [did not see|failed to yield to|misjudged the speed of] {W} while merging[ onto the highway| from the ramp|]
A merge [from the ramp|onto the highway] was [attempted|made|begun] by {V} [as|while] {W} was [passing|alongside|in the next lane]
{W} was [alongside|in the through lane] when {V} merged[ from the ramp|]
{V}, entering the highway [from the ramp|from the on-ramp], [merged|moved] into the path of {W}
{V} merging from ramp[, failed to yield to {W}|]
The ramp ended and {V} merged into the lane [occupied by|of] {W}
~{V} tried to squeeze in from the ramp
"""),
    "overtaking": clauses("""
{V} attempted to [pass|overtake] [another vehicle|a slower vehicle|on the left][ and entered the {opp} lane|]
{V} was passing [on the left|a slower vehicle] in the {opp} lane
{V} [moved|crossed|went] into the {opp} lane to [pass|overtake] [slower traffic|another vehicle|a truck]
While [passing|overtaking] [a slower vehicle|traffic|on the left], {V} [was in|occupied|traveled in] the {opp} lane
The driver of {V} [began|started|initiated] a passing maneuver [on the left|in the {opp} lane]
A passing maneuver was [attempted|begun] by {V}[ in the {opp} lane|]
In order to pass, {V} [crossed the center line|entered the {opp} lane|used the {opp} lane]
{V}, [passing|overtaking] on the left, [met {W}|was in the {opp} lane|did not see {W}]
{V} passing in {opp} lane
The driver of {V} [thought|believed] there was room to pass and moved into the {opp} lane
~{V} pulled out to get around a slow vehicle
"""),
}

enlarge("critical", globals())
