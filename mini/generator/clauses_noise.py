# ruff: noqa: E501 - one clause a line
"""Clauses that say nothing of the scene: occupants, injuries, interviews, health, codes, police.

They hold vehicle names, directions and verbs on purpose: half of a real report is like this. {V} {W} mention
vehicles, {He} {he} {his} the driver, {sex} {age}; {kn} a rest of numbers, {mph} a driver's speed.
"""

from __future__ import annotations

from mini.generator.further import enlarge
from mini.generator.grammar import clauses

TOW = clauses("""
{V} was towed due to [disabling |]damage
Both vehicles were towed[ from the scene|] due to [disabling vehicle |vehicle |]damage
{V} was driven from the scene
{V} was towed and {W} was driven from the scene
{V} was towed from the scene[ by a wrecker|]
Due to [disabling |]damage, {V} [was towed|had to be towed] [from the scene|away]
{V} sustained [disabling|moderate|functional|minor] damage and was [towed|driven] from the scene
{V} was not towed[ due to damage|][ and was driven away|]
The damage to {V} was [minor|moderate|severe|disabling][, and it was towed|]
{V}, which was [disabled|no longer drivable|heavily damaged], was towed
Neither {V} nor {W} was towed[ from the scene|]
{V} was driven away and {W} was towed[ due to disabling damage|]
[After the crash|Following the crash|Later], {V} was [moved|towed] to [the shoulder|a parking lot|a tow yard|a private lot]
The owner of {V} had it towed [home|to a repair shop|to a body shop]
{V} towed[ due to damage|, {W} driven from scene|]
Both vehicles were [driven|moved] from the scene[ by their drivers|]
{V} was inspected [at a tow yard|at a salvage yard|at the home of its owner|at a body shop][ {k} days after the crash|]
An inspection of {V} [could not be done|was not possible|was completed {k} days later]
{V} was a total loss[ and was towed to a salvage yard|]
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
There were [no passengers|{k} passengers|{k} passengers, none of them injured,] in {V}
The [only |]occupant of {V}, a {age} {sex}, [was unhurt|complained of {anyside} shoulder pain|suffered a broken wrist]
{His} seat belt was [in use|fastened|not in use] and the [frontal|driver's|steering wheel] air bag [deployed|did not deploy]
The driver, a {age} {sex}, was [transported|taken|flown] to a [hospital|trauma center] with [minor|incapacitating|non-life-threatening] injuries
[Paramedics|Emergency crews|Rescue workers] had to [extricate|free] the driver of {V}
The driver of {V} had to be [extricated|cut out|helped out] by [the fire department|rescue personnel|bystanders]
[A|One] passenger in {V} was [seated in the rear|in the second row|in the {anyside} rear seat] and was [belted|in a booster seat|unrestrained]
{V} carried [no passengers|[a family of four|{k} passengers][, all of whom were belted|]]
All [occupants|{k} occupants] of {V} were [wearing their seat belts|restrained|treated at the scene and released]
As a result of the crash, the {age} {sex} [sustained|suffered] [a head injury|rib fractures|a fractured pelvis|cuts to the {anyside} hand]
{He} [complained of|was treated for] [neck and back pain|chest pain|a bruised {anyside} knee|a headache] [at the scene|at a hospital|the next day]
The air bags in {V} [deployed|did not deploy][ and the driver was belted|]
{V} was equipped with [dual front air bags|side curtain air bags|frontal air bags], which [deployed|did not deploy]
The {age} {sex} was [properly |]belted[ with the lap and shoulder belt|]
[Transported|Taken] by [ambulance|helicopter|a family member], {he} was [admitted for {k} days|treated and released|kept overnight]
{His} passenger[, a {age} {sex},|] was [also belted|not injured|transported with neck pain]
The {age} driver of {V} [died at the hospital|was killed|was fatally injured]
The driver was [unrestrained|partially ejected|found outside the vehicle] and [suffered multiple injuries|was airlifted from the scene]
The driver of {V} declined [treatment|transport|medical attention]
Injuries to the driver of {V} were [minor|serious|limited to bruises|unknown]
Driver of {V} ({age} {sex}) [belted|not belted], [no injuries|minor injuries|possible injury]
{He} struck {his} [head on the side window|knees on the dash|chest on the steering wheel] and [bled|bruised|was sore for {k} days]
{He} was able to [get out|exit the vehicle|walk away] [without help|on {his} own|through the {anyside} door]
The seat belt [left a bruise on {his} {anyside} shoulder|locked and held {his} body in place|was cut by rescue personnel]
Sitting [in the {anyside} rear seat|beside the driver], a {sex} passenger [was thrown forward|was wearing a lap belt|was not injured]
The case occupant, [the|this] {age} {sex}, was [seated in the driver's seat|the driver of {V}|in the {anyside} front seat]
[Two|Three] children in the second row of {V} were [in child seats|restrained by lap belts|unhurt]
The {sex} driver of {V}, who was [belted|not belted|using a seat belt], was [{k} months pregnant|checked at the scene|hospitalized overnight]
Medical records [were not available|were obtained|showed a {anyside} rib fracture] for the driver of {V}
{He} had [no visible injuries|a cut above the {anyside} eye|glass fragments in {his} {anyside} arm]
No one else was in {V}
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
{He} told [police|investigators|the researcher] that {he} [did not see {W} until impact|had checked the {any4}bound traffic|was looking for an address]
{He} [recalled|remembered] [seeing {W} out of the corner of {his} eye|a loud crash|being pushed to the {anyside}|spinning]
{He} [believed|thought|felt] [{W} was going too fast|{W} would stop|{he} had the right of way|there was nothing more {he} could do]
The driver of {V} [claimed|reported|explained|indicated] that [the brakes failed|the sun was low|{he} had a green light|{he} had been waved on]
[When|Before|After] {he} looked [{anyside}|back|up|ahead], {he} saw {W} [coming|right there|only {m} meters away]
[Looking|Having looked] [{anyside}|both ways], {he} [saw no one|saw no traffic|did not see {W}]
The driver of {V} was [interviewed|contacted] [by telephone|at home|at the hospital|at the scene] and [stated|said] that {he} [was not at fault|could not stop|did not recall much]
The driver of {V} [was not|could not be] interviewed[ due to injuries| because {he} could not be reached|]
An interview with the driver of {V} [was conducted|was completed] [at the scene|by phone|{k} days later]
A passenger in {V} [said|stated|reported] that [the driver was looking {anyside}|{W} appeared suddenly|the radio was on]
[Witnesses|Two witnesses|Several bystanders] [reported|said|told police] that {V} was [speeding|weaving|traveling slowly]
{He} had [just left|been on {his} way from] [work|a restaurant|a relative's house|the gym] when the crash [happened|occurred]
{He} was [headed|going] {any8} [to pick up a child|to a doctor's appointment|to the store|to visit a friend]
{He} was [late|running late|in no hurry] and [was thinking about|was on the way to] [work|a meeting|an interview]
{He} [tried|attempted] to [steer {anyside}|avoid {W}|stop], but [there was no time|the vehicle slid|it was too late]
The driver of {V} did not [remember|recall] [the crash|anything about the crash|what happened]
The last thing {he} [remembered|recalled] was [seeing headlights|looking {anyside}|hearing a horn]
{He} said that {W} [came from nowhere|was in {his} blind spot|never slowed|had its lights off]
{He} noticed {W} when it was [about |]{m} [meters|feet] away and [hit|applied] the brakes
As {he} [glanced|looked] [{anyside}|in the mirror|at the speedometer], {he} [felt the impact|heard a bang|lost sight of {W}]
{His} view [of {W} |]was [blocked|obstructed|limited] by [a parked truck|a van|a hedge|a building]
[A|The] police officer reported that {he} was [talking on the phone|confused|upset] [after the crash|at the scene]
What {he} remembered was [a flash|a horn|the sound of brakes] and then [the air bag|the crash|a spin]
Asked about the crash, {he} [replied that {W} should have stopped|could give no details|said {he} was looking for a parking space]
The driver said {he} was [unsure|not sure] [which way {W} had come from|what had happened|how fast {he} was going]
{He} knew the road and [drove it often|had no reason to hurry|was not surprised by the traffic]
{He} was traveling {spd} when {he} [first noticed the danger|saw {W}|looked {anyside}]
{He} reported [driving|traveling|going] {spd}[ before the crash|]
{He} wrote in a statement that {he} was [going|traveling] {spd}
{He} said the [traffic|weather|road] was [nothing unusual|normal for that hour|no problem]
Driver of {V} stated [{he} did not see {W}|{he} looked {anyside}|{W} failed to yield|{he} could not stop]
Per [police|the officer], driver of {V} [was inattentive|gave no statement|stated {he} did not see {W}]
{He} and {his} passenger were [talking|listening to music|arguing|looking for a street name] [before the crash|when {he} saw {W}]
The driver's spouse stated that {he} [did not remember the crash|had been up since early morning|was still in the hospital]
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
{He} [had slept|slept] {k} hours [the night before|before the crash] and [felt rested|was tired|was not sleepy]
[On the day of the crash|That day], {he} had [worked {k} hours|felt fine|not eaten]
The driver of {V} took [medication for high blood pressure|pills for allergies|no medication][ every day|]
{He} [suffered from|had a history of] [asthma|arthritis|seizures|back problems|high cholesterol]
{His} health was [good|fair|described as good|poor]
{He} had driven [this road|here|through this area] [once before|many times|every day for {k} years]
Although {he} [was tired|was in a hurry|had a cold], {he} [was alert|drove this route daily|felt able to drive]
{He} did not [need|wear|have] [glasses|contact lenses|corrective lenses] [to drive|while driving]
[With|Having] {k} years of driving experience, {he} [was comfortable|was used to the road|knew the vehicle well]
The driver had been [licensed|driving] for {k} years[ and had taken a driver education course|]
The vehicle was [bought {k} months earlier|borrowed from a friend|rented|owned by {his} employer]
{V} was [a rental|a company vehicle|owned by a relative] and {he} had driven it [only {k} times|for {k} months|rarely]
{He} was [unfamiliar|not familiar] with the [vehicle|area|road] because {he} [was visiting|had just moved there|lived in another state]
Fatigue was [not |]a factor for the driver of {V}
The driver of {V}, [a student|a nurse|a salesperson|retired|unemployed], [worked nights|had the day off|was returning from work]
{He} reported [no illness|a sore throat|no medical conditions|being under stress at work]
{He} had consumed [no alcohol|one beer|coffee] [before driving|that day|{k} hours earlier]
A [hearing aid|cane|wheelchair] was used by the driver of {V}[, who was otherwise healthy|]
Rested and [alert|in good spirits], {he} [was not distracted|had left on time|was on a familiar route]
{His} [cell phone|radio|air conditioner] was [on|off|in use] at the time
{He} [wears|was wearing] [glasses|sunglasses|contact lenses] for [driving|reading|distance]
{He} drove [mostly in the city|{k} days a week|little at night] and [had no recent crashes|had one earlier crash]
~A thyroid condition was treated with one prescription drug
""")

CODES = clauses("""
Precrash [event|stability|location] for {V}: [tracking|stayed in the original travel lane]
The critical reason was [not assigned to {V}|assigned to {V}], [a driver error|inadequate surveillance|misjudgment of gap or other's speed]
The [first|only] harmful event was a collision with [a motor vehicle|another vehicle] in transport
The critical reason for the critical event was [coded as |]a driver[-| ]related [recognition|decision|performance] [factor|error][: inadequate surveillance|: too fast for conditions|: false assumption of other's actions|: internal distraction|]
The Critical Reason [for the Critical Event |]was not coded to [this vehicle|this driver|{V}]
[An|One] associated factor[s|] coded to this driver [was|included] [the use of prescription medications|inattention|a sight line restriction|unfamiliarity with the roadway|conversing with a passenger]
No associated factors were coded to [this driver|the driver of {V}][ and {he} was not thought to have contributed to the crash|]
Coded as the critical reason was [inattention|excessive speed|an illegal maneuver|misjudgment of gap][, a driver error|]
The critical reason [for the event |]was [attributed|assigned] to the driver of {V}: [inadequate surveillance|overcompensation|following too closely|aggressive driving]
The critical reason was a [decision|performance|recognition] error by the driver of {V}[, who looked but did not see|]
{V} was not assigned the critical reason[ in this crash|]
[Factors|Conditions] that may have contributed [include|included] [traffic flow|the view|fatigue|an unfamiliar road][ and inattention|]
Contributing to the crash was [the speed of {V}|an interior distraction|poor visibility|a false assumption]
Also coded [was|for this driver was] [an external distraction|a sight obstruction|inadequate evasive action|internal conversation]
This driver was coded with [inattention|internal non-driving distraction|no associated factors|a prior crash within {k} years]
[Other|Additional] factors coded to {V} [include|were] [worn tires|use of a cell phone|being in a hurry]
The researcher [coded|assigned] [no factors|a decision error|a recognition error] to [{V}|this driver]
The researchers [felt|believed|determined] that the driver of {V} [was inattentive|had misjudged the gap|could not have avoided the crash]
Vehicle factors were [coded as none|not coded] for {V}
The avoidance maneuver of {V} was coded as [none|braking|steering {anyside}|unknown]
It was determined that {V} [had the right of way|was going too fast for conditions|had no part in causing the crash]
Primary cause: [driver inattention|failure to yield|following too closely|unsafe speed]
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
[Alcohol|Drug use] was [not |]suspected by [the police|police on scene]
The investigating officer [cited|ticketed|arrested|warned] the driver of {V}
The driver of {V} [received|was given] a [ticket|citation|warning] for [improper lane use|speeding|careless driving|failure to control]
Charges against the driver of {V} were [pending|dropped]
A blood test [was ordered for|was taken from] the driver of {V}
[Officers|Troopers|Deputies] arrived {kk} minutes [later|after the crash] and [closed the road|directed traffic|took statements]
The police report [did not mention|makes no mention of|lists] [alcohol|drugs|citations|any defects]
The scene was [measured|photographed|examined] [by investigators|on the same day|{k} days after the crash]
When investigators arrived, {V} had [been moved|already been towed|been pushed {any8}]
[Tire marks|Gouge marks|Skid marks] were [not |]visible on the {anyside} [shoulder|side]
[Skid marks|Scuff marks] of {m} meters were [found|measured|documented] at the scene
An inspection of {V} [found|revealed|showed] [no defects|worn brakes|bald tires on the {anyside}|a recall for the air bags]
The brakes of {V} were [working|in good order|worn] and its tires had [good|adequate|little] tread
{V} was [well maintained|in poor condition|due for an inspection] and had [no recalls|{k} open recalls]
[To|On] the {any8} [of the scene |]there was a [school|church|shopping center|farm field|cemetery]
[Houses|Trees|Stores|Utility poles] [stood|were located] on the {anyside} side[ of the road|]
A [parked van|large sign|row of trees|snow bank] [restricted|obstructed|partly blocked] the view [of the driver of {V}|to the {anyside}]
The view to the {anyside} was [clear|not obstructed|limited by parked cars]
There was [construction|road work|a utility crew] {m} meters {any8} of the scene
[Rush hour|Holiday|School] traffic was [moderate|heavy|light] at the time
The driver of {V} had [a valid license|a suspended license|no license|a learner's permit]
{V} was [uninsured|insured|registered in another state]
Driver of {V} cited[ for failure to yield| for inattention| for speeding|]
~No ticket was written
""")

NONCONTACT = clauses("""
Another vehicle was [ahead of|behind|beside] {V} and was not involved
A [truck|van|bus] in the next lane [was turning {anyside}|had stopped to let {V} go]
[A|An] [non-contact|uninvolved|unknown] [vehicle|pickup|truck] [had stopped|was stopped] in the {any4}bound lane
A vehicle ahead [of {V} |]slowed to turn {anyside} into a [driveway|parking lot]
Another [driver|motorist] waved {V} on
[Two|Three|Several] [other |]vehicles [passed|went by] without [being involved|contact]
A [bus|delivery truck|police car|school bus] was stopped in the {any4}bound lane and [was not involved|did not take part in the crash]
An uninvolved [vehicle|van|motorcycle] was [traveling|heading] {any8} [near|ahead of|behind] {V}
The [vehicle|pickup|car] [ahead of|behind|next to] {V} was not [contacted|involved|struck]
[Traffic|Other traffic] in the {any4}bound lane[s|] was [stopped|moving slowly|backed up]
A [cyclist|jogger|dog|deer] on the {anyside} side was [not involved|not struck|avoided]
A [phantom|non-contact] vehicle turned {anyside} and left the scene
As {V} approached, a non-contact [truck|car|van] turned {anyside}
Behind {V}, a [bus|truck|motorcycle] was able to stop without contact
Several cars had [stopped|pulled over] on the {anyside} [shoulder|side] before the crash
[One|A] [driver|motorist] in the {any4}bound lane [stopped to help|saw the crash|was a witness]
""")

SPEED = clauses("""
The driver of {V} [estimated|stated|reported|claimed] that {he} was [traveling|driving|going] {spd}[ at the time of impact| prior to the crash|]
The driver of {V} was traveling {spd} [at the time of impact|before the crash]
{V} was traveling {spd}[ prior to impact| when the crash occurred|]
{He} stated that {he} was traveling {spd}
The [estimated |]travel speed of {V} was {spd}
The interview with the driver of {V} indicated that {he} was [going|traveling] {spd}
The driver of {V}, who was not sure of {his} speed, thought {he} was [going|traveling] {spd}
{V} was [going|driving|proceeding] {spd}[ when the driver first saw the danger| at the time| at impact|]
{He} [believed|thought|guessed|recalled] {he} was [going|driving|traveling] {spd}
At [impact|the time of the crash|the time], {V} was [traveling|going] {spd}
[Just before|Immediately prior to|Before] [impact|the crash], the driver of {V} was [traveling|driving] {spd}
{He} told [the officer|police|the investigator] that {he} was [traveling|going] {spd}
{V}, which was [traveling|going] {spd}, [was under control|had its headlights on|was in good condition]
The driver, who was [traveling|driving] {spd}, [felt that was a safe speed|was keeping up with traffic|had not been in a hurry]
Traveling {spd}, the driver of {V} [was keeping up with traffic|had the cruise control off|felt safe]
The police report [states|indicates|shows] that {V} was traveling {spd}
{V} traveling {spd}[ per driver| per report|]
~By the account of its driver {V} went {spd}
~{V} moved {spd}, as its driver recalls
""")

GROUPS = {
    "tow": TOW, "occupant": OCCUPANT, "interview": INTERVIEW, "health": HEALTH, "codes": CODES, "police": POLICE,
    "noncontact": NONCONTACT,
}  # fmt: skip

enlarge("noise", globals())
