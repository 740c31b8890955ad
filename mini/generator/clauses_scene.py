# ruff: noqa: E501 - one clause a line
"""Clauses about the scene: opening, roads, conditions. Written for this project; the forms follow counts.

Slots: {jn} junction, {road} / {road2} main and other road, {lim} / {lim2} their limits, {tcd} control,
{light} {wx} {surf} conditions, {day} {tod} noise, {xb} {dir} of the first vehicle, {curve}.
"""

from __future__ import annotations

from mini.generator.further import enlarge
from mini.generator.grammar import clauses, tables

OPENING_JUNCTION = clauses("""
[This|The] [{day} |]crash took place [at|in] the intersection of {road} and {road2}[ during the {tod}|]
[This|The] [motor vehicle |two-vehicle |]crash [took place|happened] [in|at] {jn} [of|between] {road} and {road2}
The crash [occurred|took place] in the middle of {jn}[ {tcd}|]
It [occurred|happened] [on a {day}|in the {tod}|on a {day} {tod}] at {jn} [of|involving] {road} and {road2}
[In|During] the {tod} [of a {day}|hours], two vehicles [collided|crashed] at {jn}[ of {road} and {road2}|]
[Two|The] vehicles [collided|crashed] [at|in] {jn} [on {road}|of {road} and {road2}]
This [crash|event] involved two vehicles at {jn} of {road} and {road2}
The [crash|impact] [occurred|was] within {jn} [where {road2} intersects {road}|where {road} is intersected by {road2}]
{Road} [intersects with|is joined by] {road2} at {jn}, and the crash [occurred|happened] there
The scene [of the crash |]was {jn} [involving|with] {road} and {road2}
[The|This] crash occurred [at|in] {jn} of {road} and {road2}
[The|This] [two-vehicle |]crash occurred in the intersection of {road} and {road2}
[The|This] crash [took place|happened] at {jn}[ {tcd}|] during the {tod} of a {day}
[The|This] crash occurred [in the middle of|within|at] {jn} [{tcd}|]
The crash occurred [on a {day} {tod}|in the {tod}] [at|in] {jn} where {road2} meets {road}
This crash occurred on {road} [at|near] {jn}[ with {road2}|]
~[The|This] [collision|crash] [being reported|reported here] [took place|occurred] where {road} and {road2} cross, which is {jn}
~A [{day} |]{tod} crash [happened|occurred] at {jn} formed by {road} and {road2}
~{Jn} of {road} and {road2} was the [site|location] of this crash
The crash [occurred|took place] in the {xb} lane[s|] of {road} [at|near] {jn}
[This|The] intersection[ related|-related] crash occurred [at|in] {jn} of {road} [with|and] {road2}
""")

OPENING_DRIVEWAY = clauses("""
[The|This] crash [took place|happened] [near|at] [a|the] driveway [on|along] {road}
It occurred on {road} [next to|in front of|at] [a|the] [business |residential |]driveway
[In|During] the {tod}, the vehicles [collided|crashed] [where|at a point where] a driveway [enters|connects with] {road}
A driveway [intersects|connects to|enters] {road} [at this location|here], and the crash [occurred|took place] there
[The|This] crash occurred [on|in the {xb} lane of] {road} [at|near] [a private|a|a business|the entrance of a] driveway
[The|This] crash occurred [on|in the {xb} lane of] {road} [with an adjacent|next to a] [private |commercial |]driveway
The crash [took place|occurred] on {road} where a [parking lot|private|gas station|residential] driveway [joins|intersects|enters][ it|]
~This crash [happened|occurred] at the mouth of a [parking lot|driveway|store entrance] on {road}
~{Road}, where a driveway [comes in|joins] from the {stemdir}, was the site of this crash
""")

OPENING_PLAIN = clauses("""
The crash occurred on {road}[ on a {day}| during the {tod}|]
This [motor vehicle |]crash took place mid-block on {road}
[This|The] crash [occurred|took place] in the {xb} lane[s|] of {road}[ during the {tod}|]
[In|During] the {tod}, the vehicles [collided|crashed] on {road}
It [happened|took place|occurred] [along|on] {road} [with|that had] a speed limit of {lim}
The [crash|collision] scene was on {road}[ that runs {axis}|]
The location [of the crash |]was {road}
On a {day} [{tod} |]a crash [occurred|took place] on {road}
[The|This] [two-vehicle |]crash occurred [on|in the {xb} lane[s|] of] {road}
[The|This] crash [took place|occurred] [mid-block |]on {road}[ with a posted speed limit of {lim}|]
[The|This] crash occurred on a {day} {tod} [on|in the {xb} lane[s|] of] {road}
[The|This] crash occurred during the {tod} [hours |]on {road}[ that ran {axis}| running {axis}|]
It [occurred|took place] on {road} [that ran {axis}|in the {tod}|on a {day}]
~The [site|scene] of this [{day} |]crash was {road}[ running {axis}|]
~[A|This] [{tod}|{day}] crash [happened|occurred] along {road}
""")

OPENING_MERGE = clauses("""
[The|This] crash [occurred|took place] [just after|at the point] where an [entrance|on] ramp [merges with|enters|meets] the {xb} lanes of {road}
It [happened|occurred] on {road} [near the end of|just past] an [entrance|on] ramp
The [crash|collision] scene was the {xb} lanes of {road} at an [on-ramp|entrance ramp]
[The|This] crash occurred [where an entrance ramp merges with|at the on-ramp to|on] the {xb} lanes of {road}
[The|This] crash [took place|occurred] in the {xb} lanes of {road} [near|at] [an on ramp|an entrance ramp|a merge lane]
~An entrance ramp that [joins|feeds] the {xb} side of {road} was the [site|location] of this crash
""")

ROAD = clauses("""
The [road|roadway|street] [had|carried] a [posted |]speed limit of {lim}
[Posted speed|The posted speed|Speed limit] [was|is] {lim}[ for this road[way|]|]
The [maximum|legal|posted] speed on this [road|roadway|street] [was|is] {lim}
The {axis} [road|roadway] ran [straight and level|level] and was posted at {lim}
This [section|stretch] of [road|roadway] [was|is] {roadbare}[ posted at {lim}| with a {lim} speed limit|]
The {axis} [roadway|road|street] consisted of {roadbare}[, posted at {lim}|]
Running {axis} [was|is] {roadbare}
It [had|has] a [posted |]speed limit of {lim} and [was|is] [straight|level|straight and level]
With a posted speed limit of {lim}, the [road|roadway|street] [was|is] {roadbare}
Signs [on the {axis} road[way|]|] [gave|showed] a [speed limit|limit] of {lim}
This [road|roadway|street|highway] was {roadbare}[, with a limit of {lim}|]
The crash site was {roadbare}
The {axis} road[way|] was [straight|level|straight and level] with a speed limit of {lim}
{Road} [was posted at|had a limit of|carried a limit of] {lim}
The area had a speed limit of {lim}
The [roadway|road] was [straight and level|level|straight] [and had|with] a posted speed limit of {lim}
The posted speed limit [was|is] {lim}
The speed limit [was|is] posted at {lim}[ and the road was [level|straight]|]
The {axis} [roadway|road|street] [is|was] {roadbare}[ and level|]
The {axis} [roadway|road] had a [posted |]speed limit of {lim}
[There is|There was] a posted speed limit of {lim} [for {xb} traffic|on this stretch of road|]
It [consisted of|was] {roadbare}[ and had a speed limit of {lim}|]
~{lim} was the [posted|legal] limit [here|on this road|for this section of roadway]
~Traffic [here|on this road] is limited to {lim}
~The {axis} [road|street] was [built|laid out] as {roadbare}
""")

ROAD2 = clauses("""
The [side|cross|minor] [road|street] [was|is] {road2bare}[ posted at {lim2}|]
The posted speed limit on the [other|intersecting|cross] [road|street] [was|is] {lim2}
The [intersecting|cross] [road|street] ran {axis2} and was {road2bare}
[On the {axis2} road[way|]|For the side street], the [posted |]speed limit [was|is] {lim2}
It [is|was] [crossed|intersected|joined] by {road2full}
The {axis2} [road|street] [had|has] a [posted |]limit of {lim2} and [was|is] {road2bare}
Speed limits [were|are] {lim} on the {axis} road[way|] and {lim2} on the {axis2} road[way|]
The {axis2} [roadway|road|street] was {road2bare}
The [other|second|intersecting] [roadway|road|street], which ran {axis2}, had a speed limit of {lim2}
It intersected with {road2full}
The intersecting [roadway|road|street] [was|is] {road2bare}[ with a speed limit of {lim2}|]
The [secondary|cross|side] street [was|is] {road2bare}
The {axis2} [roadway|road] [was|is] {road2bare}[ and had a posted speed limit of {lim2}|]
The posted speed limit [was|is] {lim} for the {axis} road[way|] and {lim2} for the {axis2} road[way|]
~[Crossing|Meeting] it was {road2full}
~The other [road|street], running {axis2}, [was|is] {road2bare}
""")

ROAD_LANES = clauses("""
{Ab} traffic had {alist} and {bb} traffic had {blist}
There [were|are] {alist} for {ab} traffic and {blist} for {bb} traffic
The {axis0} [road|roadway|street] [had|has|consisted of] {alist} {ab} and {blist} {bb}
In the {ab} direction there [were|are] {alist}, in the {bb} direction {blist}
{Ab} [vehicles|drivers] have {alist}; {bb} [vehicles|drivers] have {blist}
The {axis0} [road|roadway] consists of {alist} for {ab} and {blist} for {bb} vehicles
""")

CURVE = clauses("""
[There was|There is] a [sharp |gradual |slight |]{curve} curve [in the road |]for {xb} [traffic|drivers|vehicles]
The road[way|] [turns|turned|curves|curved] [gradually |sharply |]to the {curve} [in the {xb} direction|for traffic heading {dir}]
[Going|Heading|Traveling] {dir}, the road[way|] [curves|curved] to the {curve}
The {xb} lane[s|] [had|has] a {curve} curve[ with a radius of {radius} meters|]
The crash [site|scene] was in a {curve} curve for {xb} [traffic|vehicles]
The road[way|] was curved to the {curve} for {xb} traffic
{V} was in a curve to the {curve}
The [roadway|road] curve[s|d] to the {curve} for {xb} traffic[ with a radius of {radius} meters|]
The {xb} [roadway|lane] [curves|curved] to the {curve}[ with a radius of curvature of {radius} m|]
There [is|was] a curve to the {curve} for {xb} vehicles
~For {xb} traffic the road bends [sharply |gently |]{curve}
""")

CONTROL = {
    "signal": clauses("""
[Traffic|The intersection] [was|is] [governed|regulated] by [a traffic signal|traffic signals|a traffic control signal]
[An overhead|An operating|A working] traffic [signal|light] [controlled|regulated] the intersection
The traffic [signal|light] [was|is] [working|functioning|operational][ at the time of the crash|]
The traffic control device was [a signal|a traffic signal|an operating signal]
[Signals|Signal lights] control traffic [in all directions|at this location|from all directions]
The [light|signal] [was|had turned] [green|red|yellow] for {V}
A [three-phase |three-color |]traffic signal [was present|controlled traffic|was in operation] at the intersection
[Traffic|All traffic] was controlled by an operating traffic signal
{V} had a [green|red] light[ at the signal|]
The intersection was signalized
The intersection [was|is] controlled by [traffic signals|a traffic signal|a traffic light|traffic control signals|a tri-colored traffic signal]
[Traffic signals|Traffic lights] [controlled|control] the intersection
There [was|is] a [functioning |working |]traffic [control |]signal at the intersection
~[All|The] approaches [had|have] [tri-colored|red, yellow and green] lights
"""),
    "stop": clauses("""
{Cxb} [traffic|drivers] [faced|had] a stop sign
{Cxb} traffic [was|is] [governed by|subject to] a stop sign
Stop signs [were|are] [posted|in place|present] for {cxb} traffic
A stop sign [controls|controlled] {cxb} traffic
The traffic control device was a stop sign [for|facing] {cxb} [traffic|vehicles]
Traffic on the {caxis} road[way|] [had|has] a stop sign[ and the other road had none|]
There [was|is] a stop sign for {cxb} traffic
A stop sign faced {cxb} traffic
The {caxis} road[way|] was controlled by stop signs
The intersection [was|is] controlled by [a stop sign|stop signs] for {cxb} traffic
The {cxb} [travel |]lane[s|] [was|were] controlled by a stop sign
{Cxb} traffic [was|is] controlled by [a stop sign|stop signs][ at this intersection|]
[Only the|The] {caxis} [road|roadway|street] [had|has] [a stop sign|stop signs]
~A driver who is {cxb} [must|has to] stop at a [posted |]stop sign
"""),
    "all": clauses("""
The intersection had stop signs [for|facing] [every direction|all directions]
Both roads [had|have] stop signs
A stop sign was [posted|present] in each direction
Traffic in all directions [was|is] controlled by stop signs
It was a four way stop
There were stop signs [on all sides|for all traffic|at all corners]
The intersection [was|is] [a four-way stop|an all-way stop|controlled by stop signs in all directions|controlled by stop signs on all legs]
Stop signs [controlled|control] [all directions|every approach|all approaches] of the intersection
~[Each|Every] [approach|leg] [had|has] a stop sign
"""),
    "flashing": clauses("""
Flashing [lights|signals] controlled the intersection
The signal was [in flashing mode|set to flash|flashing]
A flashing signal [was present|was in operation|controlled traffic]
The intersection [was|is] controlled by [flashing signals|a flashing red and yellow signal|flashing lights]
There [was|is] a flashing [signal|light|yellow light] at the intersection
~A blinking [light|beacon] hung over the intersection
"""),
    "yield": clauses("""
A yield sign [faced|was posted for] {cxb} traffic
{Cxb} [vehicles|traffic] had a yield sign
The traffic control was a yield sign for {cxb} traffic
A yield sign controlled {cxb} traffic
{Cxb} traffic [was|is] controlled by a yield sign
There [was|is] a yield sign for {cxb} traffic
~{Cxb} drivers [must|have to] yield
"""),
    "none": clauses("""
The intersection [was|is] [not controlled|without traffic control|without any controls]
Traffic [was|is] not controlled [at this intersection|here|in any direction]
There [was|is] neither a [signal nor a stop sign|stop sign nor a signal]
There was no traffic [control|signal|control device] [at this intersection|here|present]
The intersection had no controls
There [were|are] no traffic control[s| devices] [at the intersection|at this location|associated with this roadway|present]
The intersection [was|is] uncontrolled
~No [sign|signal or sign] [regulated|controlled] traffic here
"""),
}

CONDITIONS = clauses("""
Weather [conditions were|was] {wx}, lighting [was|conditions were] {light} and the road was {surf}
At the time [of the crash |][conditions were|it was] {wx}, {light} and {surf}
The crash happened while it was {light}[ and {wx}|]; the [road|pavement|roadway] was {surf}
The surface was {surf}, the light condition was {light} and the weather [condition |]was {wx}
It was [a {day} {tod} and |]{light}, {wx} and the [road was|roads were] {surf}
[Environmental|Ambient] conditions [included|were] {light}, {wx} and {surf}
[Conditions|Crash conditions]: {light}, {wx}, {surf}
The conditions were as follows: {light}, {wx}, and the roadway was {surf}
The road was {surf} [at the time|when the crash occurred] and the weather was {wx}
It was {wx} at the time [of the crash |]and the [road was|roads were] {surf}
It was {light}[ at the time of the crash|]
The [pavement|road surface] was {surf}[ at the time|]
The crash [occurred|happened] [in|under] {light} conditions; it was {wx} and the road was {surf}
The [environmental |weather |]conditions were {wx}, {light} and {surf}
[Roads|The roads|Road surfaces] were {surf}, the weather [was |]{wx} and the lighting [was |]{light}
At the time of the crash it was {light} and {wx}, with a {surf} road surface
Lighting was {light}, weather was {wx}, road surface was {surf}
It was {wx} and {light} and the [asphalt|concrete|pavement] was {surf}
It was {light}, [the sky was|the weather was] {wx}, and the [bituminous|concrete|asphalt|] road[way|] [surface |]was {surf}
It was {light}, {wx}, and the [bituminous |concrete |]road[s were|way was|surface was| was] {surf}
[The weather was|Weather was|It was] {wx}, the road[way|] [was|surface was|] {surf} and it was {light}[ at the time of the crash|]
Conditions were {light} and {surf}[ with {wx} [skies|weather]|] [in the {tod}|] on a {day}
The roadway was {surf}[,| and] it was {light} and [the weather was|] {wx}
The weather was {wx} and the [roadway|road] was {surf}
The [roadway|road surface] was {surf}[ and level|] and it was {light}
Conditions at the time [of the crash |]were {light}, {wx} and {surf}
It was {light} [in the {tod}|] and {wx}
~[At the time|When it happened] it was {light} with {wx} [conditions|weather] and {surf} pavement
~The pavement was {surf}, the [sky|weather] {wx}, and it was {light}
~{Surf} [pavement|road surface] and {wx} weather were [noted|present]; it was {light}
""")

LIGHT = tables(
    day="daylight|light|day time|during the day|daylight conditions|daylight|daylight|daytime|during daylight hours|broad daylight|daytime hours|during daytime|bright daylight|in the daytime|lit by daylight|daylight hours|~full daylight|~light out",
    dusk="dusk|twilight|at dusk|dusk|near dusk|sunset|at sunset|just after sunset|evening twilight|dusk hours|~getting dark",
    dawn="dawn|at dawn|just before sunrise|dawn|sunrise|at sunrise|near dawn|morning twilight|first light|daybreak|dawn hours|~early dawn",
    dark="dark|dark with no lights|dark with no artificial lighting|after dark on an unlit road|dark and not lighted|dark, unlighted|dark with no streetlights|dark and unlit|dark, there were no streetlights|dark out|dark and without lighting|unlit and dark|night with no lighting|dark (not lighted)|nighttime, unlighted|dark, no lights|night and unlit|~nighttime without street lights|~pitch dark",
    dark_lit="dark with overhead lighting|dark with street lights|lit by overhead lights|dark with artificial lighting|dark and lighted|dark with artificial illumination|dark with streetlights|dark, but lighted|dark but lighted|dark with lights|illuminated|night with overhead lighting|dark (lighted)|dark, lighted|dark with functioning streetlights|nighttime with artificial lighting|dark, lit by street lights|dark with street lighting|night and illuminated|~night, with street lamps lit|~dark though the street lights were on",
)
WEATHER = tables(
    clear="clear|clear skies|with no adverse weather|without precipitation|good|clear|clear|clear with no adverse conditions|clear and sunny|nice|fine|without rain or snow|clear with good visibility|with clear skies|with no precipitation|~sunny|~fair",
    cloudy="cloudy|cloudy skies|mostly cloudy|overcast skies|cloudy|overcast|partly cloudy|cloud covered|somewhat cloudy|mainly cloudy|heavily overcast|cloudy with no precipitation|overcast and cloudy|dull|~gray and clouded",
    rain="raining|rain|light rain|heavy rain|showers|pouring rain|raining|rainy|raining lightly|raining heavily|rain falling|light showers|a downpour|moderate rain|rain showers|stormy with rain|thunderstorms|raining steadily|wet weather|~wet with a steady rain|~drizzling",
    snow="snowing|snow|light snow|heavy snow|blowing snow|snowing|snowing lightly|snow falling|snow flurries|snow showers|moderate snow|a snowstorm|blizzard conditions|~snowy with flakes falling",
    sleet="sleeting|sleet|a wintry mix|sleeting|ice pellets|mixed rain and sleet|sleet falling|rain mixed with snow|hail|~freezing rain and sleet",
    fog="foggy|fog|dense fog|hazy|foggy|thick fog|patchy fog|fog with low visibility|fog limiting visibility|fog and haze|~misty with fog",
)
SURFACE = tables(
    dry="dry|dry and level|free of moisture|dry|dry|bare and dry|in dry condition|free of water|dry with no defects|~dry and clean",
    wet="wet|wet with rain|rain soaked|wet and slippery|moist|wet|wet|wet from rain|rain-soaked|wet due to rain|water covered|covered with water|soaked|wet on the surface|wet with standing water|~damp|~slick and wet",
    snow="snow covered|snowy|covered in snow|slushy|snow-covered|covered with snow|under snow|snow packed|slush covered|covered by fresh snow|~under packed snow",
    ice="icy|covered with ice|glazed with ice|slippery with ice|icy|ice covered|ice-covered|icy and slippery|coated in ice|frozen|covered with black ice|partly icy|~iced over|~slick with ice",
)

enlarge("scene", globals())
