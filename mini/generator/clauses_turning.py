# ruff: noqa: E501 - one clause a line
"""Clauses about errors of those who cross, turn or back: what {V} does in the way of {W}.

{axis} {axis} a road's run, {opp} the heading of oncoming traffic.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

TURNING = {
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
{V} [continued|went|drove] straight into the intersection [as|while] {W} [did the same|was passing through it]
{V} was crossing the intersecting road[way|] when {W} [arrived|came along|reached the intersection]
The driver of {V} did not see {W} and [drove|went|continued] [straight |]into the intersection
The driver of {V} [looked|stopped and looked] both ways, did not see {W}, and [started|drove|proceeded] across[ the intersecting road|]
[After stopping|After coming to a stop|Without coming to a complete stop], {V} [proceeded|drove] [straight |]across the [intersection|intersecting road]
[Failing to yield|Not seeing {W}|Believing the way was clear], the driver of {V} [drove|proceeded|continued] straight [into|through] the intersection
The intersection was entered by {V} [just as|at the moment when] {W} was [crossing|passing through]
{V}, which [had stopped|did not stop|had slowed], [continued|proceeded] straight [across|into the intersection]
{V} [passed|went|traveled] straight through the [red light|stop sign][ and met {W} in the middle of the intersection|]
The driver of {V} disregarded the [stop sign|traffic signal|red light] and entered the intersection
{V} and {W} [went|drove|continued] straight and their paths crossed in the [center|middle] of the intersection
{V} was going straight through the intersection when {W} [came into|entered] it
{W} was [already |]in the intersection when {V} [entered|drove straight in]
As {W} [passed through|was in] the intersection, {V} [continued|drove|went] straight [into it|ahead][ as well|]
{V} [did not yield|failed to give way] to {W} [as it crossed|when crossing|while crossing] the [intersection|road|roadway]
{V} left the stop [line|sign] and [crossed|started across|headed across] the road[way|]
The driver of {V} misjudged the [speed of|distance to|gap ahead of] {W} and [attempted|started|tried] to [cross|go straight across]
Neither driver [stopped|slowed], and [both vehicles|{V} and {W}] [drove|went] into the intersection
{V} [accelerated|rolled|moved forward] into the intersection[, where {W} was crossing| and into the path of {W}|]
{V} entered intersection[ without stopping| against signal|], {W} [also entered|was crossing]
In an attempt to cross the [intersection|intersecting road], {V} [drove|moved|proceeded] into the path of {W}
{V} was driven straight into the intersection [without yielding|in front of {W}]
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
{V} turned left and [did not yield|failed to yield|failed to give the right of way] to {W}
{V} [made|was making|had begun] a left turn [through a gap in traffic |at the intersection |]and [entered|crossed into|was in] the path of {W}
The driver of {V} [did not see|failed to see|never saw] {W} [and turned left|before turning left|when turning left|and started a left turn]
While turning left, {V} [crossed|moved|drove] into the [lane|path] of {W}
During its left turn, {V} [entered|moved into|blocked] the [lane|path] of {W}
A left turn was [attempted|started|made|begun] by {V} [as|when|while] {W} was [approaching|oncoming|going straight]
The driver of {V} [misjudged the speed of|misjudged the distance to|thought there was time before|hurried to beat] {W} and [turned left|made a left turn]
{V}, [intending|waiting|attempting] to turn left, [pulled forward|drove|turned] into the path of {W}
{W} was [proceeding|continuing|traveling] straight [ahead|through] when {V} [turned left|began turning left|made a turn to the left]
{W} entered the intersection from the opposite direction [and|as] {V} [turned left|was turning left] [in front of it|into its path]
{V} was [in the process of|in the midst of|part way through] a left turn when it [entered|was in] the [path|lane] of {W}
The left turn of {V} [took|brought|carried] it into the [lane|path] of {W}
[On a green light|On the green signal|At the intersection], {V} turned left [into|across] the path of {W}
Without [waiting|yielding|stopping], {V} turned left [ahead of|in front of] {W}
{V} turned left; {W} was [approaching|coming] from the opposite direction
{V} turning left, {W} going straight[ in the opposite direction|]
{V} turning left failed to yield[ to {W}|]
The driver of {V}, who [did not see|misjudged] {W}, [initiated|attempted|started] a left turn
{V} [initiated|commenced|executed] a left[-hand|] turn [at the intersection|toward the side road] and was in the path of {W}
Thinking [the way was clear|there was time|{W} would stop|the light favored a turn], the driver of {V} turned left
{V} [crossed|started across] the {opp} lane[s|] in a left turn[ in front of {W}| and met {W}|]
~{V} swung left [into the way|in front] of the oncoming {W0}
~Making a left, {V} cut off {W}
"""),
    "turn_left": clauses("""
{V} was making a left turn when {W} approached
{V} pulled [out|away] from the stop and turned left
The driver of {V} entered the road to go left and did not see {W}
{V} started out, turning left in front of {W}
{V} [attempted|began|started] to [turn left|make a left turn] [onto the {axis} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn left [in front of|into the path of] {W}
The driver of {V} attempted to turn left [and|but] failed to yield to {W}
{V} [entered the roadway|entered the intersection], turning left, [into|across] the path of {W}
{V} turned left in front of {W}
{V} [left|exited|came out of] the [driveway|side road|side street|parking lot] and turned left[ in front of {W}| into the path of {W}|]
{V} [drove|moved|proceeded] from the stop sign and turned left [into|onto] the road[way|]
The driver of {V} did not see {W} [approaching|coming] and [turned left|started a left turn|pulled out to the left]
While turning left [onto|into] the [main road|road|roadway|street], {V} entered the path of {W}
[From a stop|After stopping|After coming to a stop|After a brief stop], {V} [turned left|made a left turn|began a left turn] [in front of|and failed to yield to|into the path of] {W}
A left turn [onto the {axis} road[way|] |]was [attempted|started|begun] by {V} as {W} [approached|was passing]
{W} was [approaching|passing|going straight] [on the main road |on the through road |]when {V} [pulled out|entered the road] and turned left
The driver of {V} [misjudged the gap|thought the way was clear|saw a gap in traffic|looked both ways] and [turned left|made a turn to the left|pulled out to the left]
{V}, turning left [onto|into] the road[way|], [did not yield to|drove into the path of|pulled in front of] {W}
{V} was [in the process of|in the midst of] turning left [out of the driveway|onto the {axis} road[way|]|from the side street] and entered the path of {W}
The left turn of {V} [took|brought] it into the [lane|path] of {W}
{V} had [begun|started|nearly completed] a left turn [onto the {axis} road[way|] |]when {W} [arrived|approached|came along]
{V} [accelerated|moved forward|rolled forward] to [turn left|make a left turn] and [entered|blocked] the lane of {W}
Intending to [go|turn] left, {V} [entered the road|pulled into the road|moved out from the stop] [in front of|into the path of] {W}
{V} made a left [turn |]out of the [side street|driveway|parking lot][ without yielding|]
{V} was [waved on|let out] by another motorist and turned left in front of {W}
{V} failed to yield [from the stop sign|from the driveway|from the side street|] while turning left
{V} turning left [from driveway|from side street|from stop sign], {W} [going straight|approaching]
The road[way|] was entered by {V}, which turned left [in front of|ahead of] {W}
{V} crossed the near lane[s|] while turning left and [met|entered the path of] {W}
~{V} nosed out to go left and got in the way of {W}
~Making a left, {V} cut off {W}
"""),
    "turn_right": clauses("""
{V} was making a right turn when {W} approached
{V} pulled [out|away] and turned right
The driver of {V} turned right without seeing {W}
{V} [attempted|began|started] to [turn right|make a right turn] [onto the {axis} road[way|]|at the intersection|]
{V} pulled out [of the driveway |]to turn right [in front of|into the path of] {W}
{V} turned right [in front of|into the path of] {W}
{V} [left|exited|came out of] the [driveway|side road|side street|parking lot] and turned right[ in front of {W}| into the path of {W}|]
The driver of {V} [did not see|failed to see|never saw] {W} [and made|before making|when starting] a right turn
While turning right[ onto the road[way|]| from the stop sign|], {V} entered the [path|lane] of {W}
[From a stop|After stopping|After a brief stop], {V} [turned right|made a right turn|began a right turn] [in front of|and failed to yield to] {W}
A right turn [onto the {axis} road[way|] |]was [attempted|started|begun] by {V} as {W} approached
{W} was [approaching|passing|going straight] when {V} [entered the road and |]turned right
The driver of {V} [misjudged the gap|thought the way was clear|looked left, saw no one,] and turned right
{V}, turning right, [did not yield to|drove into the path of|moved in front of] {W}
{V} was [in the process of|in the midst of] turning right when it [entered|moved into] the [lane|path] of {W}
The right turn of {V} [took|brought] it into the lane of {W}
{V} [made|completed|executed] a right turn [out of the driveway|from the side street|onto the road[way|]] [without yielding|in front of {W}]
Intending to [go|turn] right, {V} [pulled into the road|moved out from the stop] [in front of|into the path of] {W}
{V} failed to yield [from the stop sign|from the driveway|] while turning right
{V} turning right [from driveway|from side street|from stop sign], {W} [going straight|approaching]
~Making a right, {V} cut off {W}
~{V} nosed out to go right and got in the way of {W}
"""),
    "u_turn": clauses("""
{V} was [making|starting] a U-turn when {W} approached
{V} [attempted|began|started] [to make a|a] U-turn [in front of {W}|]
The driver of {V} made a U-turn [into|across] the path of {W}
The driver of {V} did not see {W} and [made|started|attempted] a U-turn
A U-turn was [attempted|started|made|begun] by {V} [as|when] {W} approached
While [making|attempting|executing] a U-turn, {V} [entered|crossed|blocked] the [path|lane] of {W}
{W} was [approaching|going straight] when {V} [began|made|started] a U-turn
{V}, in the [middle|midst] of a U-turn, was [in|across] the path of {W}
{V} executed a U-turn [and failed to yield to|without yielding to|in the path of] {W}
{V} making U-turn[, failed to yield to {W}|]
Intending to [reverse direction|go back the other way], the driver of {V} started a U-turn
~{V} tried to turn around in front of {W}
"""),
    "backing": clauses("""
{V} was in reverse [and entered the road|leaving a driveway]
The driver of {V} backed up and did not see {W}
{V} [was backing|backed] out of [the|a] driveway [into|in] the path of {W}
{V} was backing [onto the road[way|]|from a driveway]
{V} [backed|was being backed] from [the|a] [private |]driveway [toward|into] the road[way|]
While backing [out of the driveway|onto the road[way|]|from a driveway], {V} entered the [path|lane] of {W}
The driver of {V} [put the vehicle in reverse|looked over the shoulder] and backed [out|onto the road[way|]]
{W} was [approaching|passing] as {V} backed [out of the driveway|from the driveway|out]
The driver of {V} was backing and [did not see|failed to yield to|never saw] {W}
{V}, in reverse, [exited|was exiting|came out of] a [private |]driveway[ into the path of {W}|]
[Without looking|Not seeing {W}], the driver of {V} backed [out|onto the road[way|]|from the driveway]
{V} backing from driveway[, did not see {W}| into roadway|]
{V} moved backward out of [a|the] driveway and into the [lane|path] of {W}
~{V} reversed into the [road|street] ahead of {W}
"""),
}

PROCEEDS = {
    "turn": clauses("""
{V} then [proceeded|started|began|attempted] to turn {turn}
{V} then [started|began|initiated|made] [its|the] {turn} turn
{V} [started|began|commenced] [its|the] {turn} turn and [entered|crossed] the [path|lane] of {W}
{V} [started|began|commenced] [its|the] {turn} turn[ in front of {W}|]
[As|When] the [light|signal] [changed|turned green], {V} [began|started] to turn {turn}
[When|Once|As] [traffic|the way] [cleared|had cleared|seemed clear], {V} [turned|began to turn|started turning] {turn}
After [waiting|a short wait|a pause|several seconds|looking both ways], {V} [pulled out|moved forward|proceeded] to turn {turn}
After [waiting|a short wait|a pause|several seconds|looking both ways], {V} [turned|began to turn|made the turn to the] {turn}
{V} then [pulled out|pulled forward|moved out|accelerated] to turn {turn}
{V} [proceeded|moved|rolled] into the [intersection|roadway], turning {turn}
{V} [proceeded|moved|pulled] into the [intersection|roadway|road] and turned {turn}
Seeing no [traffic|vehicles|one coming], the driver of {V} [proceeded|started|began] to turn {turn}
The driver of {V} [thought|believed|assumed] [it was clear|there was time|there was room] and [turned|began turning|made the turn to the] {turn}
{V} let [several vehicles|a group of cars|other traffic] [pass|go by] and then turned {turn}
{V} waited for [several vehicles|a group of cars|other traffic] to [pass|clear] and then turned {turn}
A [vehicle|car] in the next lane [stopped|made room|waited] to let {V} through, and {V} turned {turn}
Another [driver|motorist] [motioned|waved] {V} on, and it [turned|began to turn] {turn}
{V} had [started|begun] [its|the] {turn} turn when {W} [arrived|came into the intersection|came along]
As {V} [began|started|was making] [its|the] {turn} turn, {W} [was going straight|came through the intersection|was passing|arrived]
{V} left the [stop line|stop sign|stop bar|turn lane] [to make|making] [a|its] {turn} turn
The driver of {V} released the brake and turned {turn}
From [its stop|a standstill|this position], {V} [began|started|made] a {turn} turn
{V} [edged|inched|crept|rolled] forward and then [turned|began to turn] {turn}
{V} [accelerated|moved off|started up] from the stop, turning {turn}[ in front of {W}|]
{V}, after its stop, [turned|was turning] {turn} [across|into] the path of {W}
[The|A] {turn} turn was then [begun|started|attempted] by {V}
{V} [resumed moving|moved again|started again], turning {turn}
{V} then turned {turn}[ in front of {W}| into the path of {W}| and {W} was there|]
The driver of {V} saw a gap and [took it|went], turning {turn}
{V} [proceeded|went on] to [turn {turn}|make the {turn} turn|make its {turn} turn] [as|while] {W} [approached|came near|was approaching]
At that [point|time|moment], {V} [turned|began to turn|started to turn] {turn}
"""),
    "cross": clauses("""
{V} then [proceeded|started|continued|drove] [into|across|through] the intersection
{V} then [pulled out|moved forward|accelerated] [into|across] the intersection[ in front of {W}|]
After [stopping|waiting|looking both ways|a pause], {V} [proceeded|started|went] [straight |]across
Seeing no [traffic|vehicles|one coming], the driver of {V} [proceeded|started|drove] [straight |]across[ the intersection| the road|]
When the [light|signal] turned green, {V} [proceeded|drove|went] straight ahead
{V} left the stop [line|sign|bar] and went straight [across|through|ahead]
{V} [started|tried|began] to cross and {W} [arrived|came along|was there]
As {V} [started across|was crossing|proceeded], {W} [entered|came into|was passing through] the intersection
{V} [inched|edged|crept|rolled] forward and then [crossed|drove across]
The driver of {V} [thought|believed|assumed] [it was clear|there was time|the road was clear] and drove straight [across|on|through]
[Once|When|As] [traffic|the way] [cleared|had cleared|seemed clear], {V} [went|drove|proceeded] straight across
Another [driver|motorist] [motioned|waved] {V} on, and it [crossed|went straight across]
{V} [resumed moving|moved again|started again] and [crossed|went straight through] the [intersection|road]
From [its stop|a standstill|this position], {V} [crossed|drove straight across|went straight on]
At that [point|time|moment], {V} [started|drove|went] straight across[ the path of {W}|]
{V} then crossed [in front of|into the path of] {W}
"""),
}
"""What one does that has stood or slowed: it goes. Trains only."""

ONWARD = clauses("""
{V} turned {turn} to [go|head|travel] {outdir}, and {W} was [close|near|upon it]
In order to go {outdir}, {V} [turned {turn}|made a {turn} turn|swung {turn}] [in front of|ahead of] {W}
{V} [turned|swung] {turn} into the {outxb} lane[s|] [in front of|ahead of|before] {W}
The driver of {V} wanted to go {outdir} and turned {turn} [in front of|ahead of] {W}
{V} was turning {turn} [for|toward] the {outxb} lane[s|] when {W} [came|arrived|appeared]
Meaning to [proceed|continue] {outdir}, {V} [turned {turn}|took a {turn}] without regard for {W}
The {turn} turn of {V} onto the {outxb} side [cut off|hindered] {W}
{V} [started|began] its {turn} turn; {outdir} was where its driver wanted to go
By a {turn} turn {V} was to become {outxb}, but {W} was [too near|in the way]
{V} was in a {turn} turn that would have taken it {outdir} when {W} [came|arrived]
Turning {turn} so as to travel {outdir}, {V} [got in the way of|hindered] {W}
{V} made a {turn} turn onto the {outxb} roadway and [did not see|overlooked] {W}
"""
)  # fmt: skip
"""One that turns, and where it meant to go: with the turn that tells where it came from. They only train."""

STRAYS = clauses("""
{V} lost control and [slid|skidded|spun] {turn} [over the lane line|across the line|into the next lane][, where {W} was| in front of {W}|]
The driver of {V} [lost control|could not hold the vehicle], and it [slid|spun|went] into the {turn} lane[ beside {W}|]
[Out of control|Sliding|Fishtailing], {V} [crossed|went over] the lane line to the {turn} [toward|in front of] {W}
{V} [fishtailed|began to spin|got out of control] and came {turn} across the lane line
A tire of {V} [blew|failed|went flat], and {V} [veered|pulled] {turn} into the lane of {W}
{V} [swerved|was steered] {turn} [to avoid something in the road|around debris|for an animal] and [crossed into|entered] the lane of {W}
{V} came [back |]from the {aside} shoulder into the lane[ of {W}|]
{V} had [stopped|been] on the {aside} shoulder and [pulled|moved|came] {turn} into the lane of {W}
[Leaving|From] the {aside} shoulder, {V} [moved|pulled|came] {turn} [in front of|beside|toward] {W}
{V} [had drifted|had gone] onto the {aside} shoulder, and its driver [overcorrected|steered back] {turn}[ into the next lane|, toward {W}|]
""")
"""One that comes into the next lane without meaning to change lanes, or from beside the road. They only train."""
