# ruff: noqa: E501 - one clause a line
"""Clauses that say nothing of the scene: occupants, injuries, interviews, health, codes, police.

They hold vehicle names, directions and verbs on purpose: half of a real report is like this. {V} {W} mention
vehicles, {He} {he} {his} the driver, {sex} {age}; {kn} a rest of numbers, {mph} a driver's speed.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

TOW = clauses("""
{V} was towed due to [disabling |]damage
Both vehicles were towed[ from the scene|] due to [disabling vehicle |vehicle |]damage
{V} was driven from the scene
{V} was towed and {W} was driven from the scene
{V} was towed from the scene[ by a wrecker|]
~A wrecker removed {V}[ and {W}|]
""")

OCCUPANT = clauses("""
The driver of {V} sustained [minor|moderate|severe] injuries and was taken to [a hospital|a trauma center] by [ambulance|helicopter]
The {age} {sex} driver was wearing [the|a] lap and shoulder belt and the [front|side] air bag[s|] [deployed|did not deploy]
{V} was occupied by a {age} {sex} driver and [one passenger|{k} passengers|a child in a safety seat]
{His} injuries [included|were] [a fractured {anyside} arm|bruises and cuts|neck pain|a broken {anyside} leg]
The {anyside} front passenger of {V} was [belted|unbelted] and [was not hurt|complained of pain]
The {age} {sex} driver of {V} [(case occupant) |]was using the available three-point seat belt and the steering-wheel air[ |]bag deployed
The {age} {sex} [driver|right-front passenger|second-row left passenger] of {V} was [not |]using the available three-point seat belt[ and no air bags deployed| but the dash-mounted airbag deployed|]
{He} was transported via [ground ambulance|helicopter] to a [local hospital|regional level-one trauma center][ and later transferred to a regional trauma center|]
{He} [was treated and released|was hospitalized for {k} days|was pronounced dead at the scene|refused treatment]
{V} was driven by a [belted |]{age} {sex} who [was not injured|sustained minor injuries|was transported, treated and released for a complaint of pain|was airlifted to a trauma center]
The driver of {V}, a {age} {sex}, [was transported to a local hospital|reported no injuries|was not injured]
A {age} [belted |]{sex} passenger in the front right seat was [also |][not injured|transported with minor injuries]
The driver of {V} was [alone in the vehicle|properly restrained|ejected from the vehicle]
Both drivers were transported to [local hospitals|an area hospital] with [minor|unknown|serious] injuries
There were [no passengers|{k} passengers] in {V}[ and none were injured|]
~EMS took the {sex} from {V} to [a clinic|an emergency room]
~Nobody in {V} was hurt
""")

INTERVIEW = clauses("""
{He} saw {W} {m} meters away and [thought|assumed] it would stop
The driver of {V} said that the sun was in {his} eyes
{He} was [turning the radio on|talking to a passenger|thinking about work] [and|when {he}] noticed {W} too late
{He} heard [tires|a horn] and looked to the {anyside}
The driver of {W} told police that {V} [came out of nowhere|was speeding|did not have its lights on]
The driver felt that {he} could [safely make it|clear the intersection|stop in time]
{He} had left [home|work|a store] {kk} minutes before and was heading {any8} to [a restaurant|an appointment|church]
{He} [stated|said|advised] that {he} [looked left|looked right|looked both ways|looked to the {any4}] and [did not see|saw] [anyone|any traffic|{W}][ coming|]
The driver of {V} [stated|said] that {he} [did not see {W}|never saw {W}|thought {W} was farther back|had no time to react|thought it was clear]
The driver of {V} [estimated|stated] that {he} was traveling {spd}[ at the time of impact| prior to the crash|]
The driver of {V} was traveling {spd} [at the time of impact|before the crash]
{He} stated that {he} was traveling {spd} when {he} [first saw|saw|noticed] {W}
No interview [could be|was] obtained [with|from] the driver of {V}
A witness stated that [the light was green|{W} was going fast|{V} did not slow]
According to the [officer|police], the driver of {V} [was inattentive|failed to look both ways|could not recall the crash]
{He} [declined to be interviewed|did not remember the crash|remembered hearing a loud bang]
The driver of {V} was on {his} way [home|to work|to school|to a friend's house] and had been driving for [about |]{kk} minutes
~In {his} own words, {he} [hardly saw|did not notice] {W}
~By {his} own account {he} drove {spd}
""")

HEALTH = clauses("""
{He} had been awake for {k} hours and reported feeling [rested|tired|fine]
The driver of {V} had [no known health problems|a history of high blood pressure|diabetes]
{He} had owned {V} for {k} years and [had no trouble with it|kept it maintained]
The driver was [in good health|rested|familiar with the road|familiar with the area] and [was not fatigued|had slept {k} hours the night before]
{He} was [not |]taking [any medications|{k} medications][ that did not contribute to the crash|]
The driver wore prescription [lenses|glasses] to correct a [myopic (nearsighted)|hyperopic (farsighted)] condition
{He} drives this [vehicle|road] [daily|weekly|several times a week]
The driver was [conversing with a passenger|talking on a cell phone|in a hurry|late for work|looking at a street sign]
~A thyroid condition was treated with one prescription drug
""")

CODES = clauses("""
The pre-event movement of {V} was [coded as |][going straight|turning left|negotiating a curve|stopped in traffic lane|changing lanes]
Precrash [event|stability|location] for {V}: [tracking|stayed in the original travel lane|departed roadway]
The critical reason was [not assigned to {V}|assigned to {V}], [a driver error|inadequate surveillance|misjudgment of gap or other's speed]
The [first|only] harmful event was a collision with [a motor vehicle|another vehicle] in transport
The Critical [Precrash|Pre-crash] Event for {V} was [coded |][as |: ][this vehicle traveling, turning left at intersection|other motor vehicle in lane, other vehicle stopped|other vehicle encroachment from crossing street, across path|this vehicle traveling over the lane line on left side of travel lane|other motor vehicle in lane traveling in same direction with higher speed]
The critical reason for the critical event was [coded as |]a driver[-| ]related [recognition|decision|performance] [factor|error][: inadequate surveillance|: too fast for conditions|: false assumption of other's actions|: internal distraction|]
The Critical Reason [for the Critical Event |]was not coded to [this vehicle|this driver|{V}]
[An|One] associated factor[s|] coded to this driver [was|included] [the use of prescription medications|inattention|a sight line restriction|unfamiliarity with the roadway|conversing with a passenger]
No associated factors were coded to [this driver|the driver of {V}][ and {he} was not thought to have contributed to the crash|]
~Nothing was coded against {V} as a cause
""")

POLICE = clauses("""
The tires of {V} were [in good condition|worn|properly inflated] and there were no vehicle [problems|defects]
[A hedge|A parked truck|A building|A hill] [blocked|limited] the view to the {anyside}
Traffic [flow was|volume was] [normal|heavy|light] with no interruptions [in the traffic stream|]
The road was bordered by [houses|businesses|trees] on the {anyside}
Photographs and measurements were taken at the scene[ {k} days later|]
The police did not consider [illegal drugs or alcohol|alcohol or illegal drugs] to be involved and ordered no tests
The driver [of {V} |]was [cited|issued a citation] for [failure to yield|following too closely|speeding|no insurance]
Police [reported that alcohol was not a factor|tested the driver of {V} for alcohol with negative results]
Traffic was [light|moderate|heavy] [at the time|during commuting hours]
[Bordering|Along] the road on the {anyside} was [a gas station|a wooded area|a carwash|a guardrail|a sidewalk]
There were no [sight restrictions|view obstructions|pre-existing vehicle defects]
~No ticket was written
""")

NONCONTACT = clauses("""
Another vehicle was [ahead of|behind|beside] {V} and was not involved
A [truck|van|bus] in the next lane [was turning {anyside}|had stopped to let {V} go]
[A|An] [non-contact|uninvolved|unknown] [vehicle|pickup|truck] [had stopped|was stopped] in the {any4}bound lane
A vehicle ahead [of {V} |]slowed to turn {anyside} into a [driveway|parking lot]
Another [driver|motorist] waved {V} on
""")

SPEED = clauses("""
The driver of {V} [estimated|stated|reported|claimed] that {he} was [traveling|driving|going] {spd}[ at the time of impact| prior to the crash|]
The driver of {V} was traveling {spd} [at the time of impact|before the crash]
{V} was traveling {spd}[ prior to impact| when the crash occurred|]
{He} stated that {he} was traveling {spd}
The [estimated |]travel speed of {V} was {spd}
~By the account of its driver {V} went {spd}
~{V} moved {spd}, as its driver recalls
""")

GROUPS = {
    "tow": TOW, "occupant": OCCUPANT, "interview": INTERVIEW, "health": HEALTH, "codes": CODES, "police": POLICE,
    "noncontact": NONCONTACT,
}  # fmt: skip
