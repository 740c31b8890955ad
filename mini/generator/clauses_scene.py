# ruff: noqa: E501 - one clause a line
"""Clauses about the scene: opening, roads, conditions. Written for this project; the forms follow counts.

Slots: {jn} junction, {road} / {road2} main and other road, {lim} / {lim2} their limits, {tcd} control,
{light} {wx} {surf} conditions, {day} {tod} noise, {xb} {dir} of the first vehicle, {curve}.
"""

from __future__ import annotations

from mini.generator.grammar import clauses

OPENING_JUNCTION = clauses("""
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
[The|This] crash occurred [on|in the {xb} lane of] {road} [at|near] [a private|a|a business|the entrance of a] driveway
[The|This] crash occurred [on|in the {xb} lane of] {road} [with an adjacent|next to a] [private |commercial |]driveway
The crash [took place|occurred] on {road} where a [parking lot|private|gas station|residential] driveway [joins|intersects|enters][ it|]
~This crash [happened|occurred] at the mouth of a [parking lot|driveway|store entrance] on {road}
~{Road}, where a driveway [comes in|joins] from the {stemdir}, was the site of this crash
""")

OPENING_PLAIN = clauses("""
[The|This] [two-vehicle |]crash occurred [on|in the {xb} lane[s|] of] {road}
[The|This] crash [took place|occurred] [mid-block |]on {road}[ with a posted speed limit of {lim}|]
[The|This] crash occurred on a {day} {tod} [on|in the {xb} lane[s|] of] {road}
[The|This] crash occurred during the {tod} [hours |]on {road}[ that ran {axis}| running {axis}|]
It [occurred|took place] on {road} [that ran {axis}|in the {tod}|on a {day}]
~The [site|scene] of this [{day} |]crash was {road}[ running {axis}|]
~[A|This] [{tod}|{day}] crash [happened|occurred] along {road}
""")

OPENING_MERGE = clauses("""
[The|This] crash occurred [where an entrance ramp merges with|at the on-ramp to|on] the {xb} lanes of {road}
[The|This] crash [took place|occurred] in the {xb} lanes of {road} [near|at] [an on ramp|an entrance ramp|a merge lane]
~An entrance ramp that [joins|feeds] the {xb} side of {road} was the [site|location] of this crash
""")

ROAD = clauses("""
This [road|roadway|street|highway] was {roadbare}[, with a limit of {lim}|]
The crash site was {roadbare}
The {axis} road[way|] was [straight|level|straight and level] with a speed limit of {lim}
{Road} [was posted at|had a limit of|carried a limit of] {lim}
The area had a speed limit of {lim}
The [roadway|road] was [straight and level|level|straight] [and|with] [had |]a posted speed limit of {lim}
The posted speed limit [was|is] {lim}[ on both roads|]
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

CURVE = clauses("""
The road[way|] was curved to the {curve} for {xb} traffic
{V} was in a curve to the {curve}
The [roadway|road] curve[s|d] to the {curve} for {xb} traffic[ with a radius of {radius} meters|]
The {xb} [roadway|lane] [curves|curved] to the {curve}[ with a radius of curvature of {radius} m|]
There [is|was] a curve to the {curve} for {xb} vehicles
~For {xb} traffic the road bends [sharply |gently |]{curve}
""")

CONTROL = {
    "signal": clauses("""
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
It was a four way stop
There were stop signs [on all sides|for all traffic|at all corners]
The intersection [was|is] [a four-way stop|an all-way stop|controlled by stop signs in all directions|controlled by stop signs on all legs]
Stop signs [controlled|control] [all directions|every approach|all approaches] of the intersection
~[Each|Every] [approach|leg] [had|has] a stop sign
"""),
    "flashing": clauses("""
The intersection [was|is] controlled by [flashing signals|a flashing red and yellow signal|flashing lights]
There [was|is] a flashing [signal|light|yellow light] at the intersection
~A blinking [light|beacon] hung over the intersection
"""),
    "yield": clauses("""
A yield sign controlled {cxb} traffic
{Cxb} traffic [was|is] controlled by a yield sign
There [was|is] a yield sign for {cxb} traffic
~{Cxb} drivers [must|have to] yield
"""),
    "none": clauses("""
There was no traffic [control|signal|control device] [at this intersection|here|present]
The intersection had no controls
There [were|are] no traffic control[s| devices] [at the intersection|at this location|associated with this roadway|present]
The intersection [was|is] uncontrolled
~No [sign|signal or sign] [regulated|controlled] traffic here
"""),
}

CONDITIONS = clauses("""
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

LIGHT = {
    "day": "daylight|light|day time|during the day|daylight conditions|daylight|daylight|daytime|during daylight hours|~full daylight|~light out",
    "dusk": "dusk|twilight|at dusk|dusk|~getting dark",
    "dawn": "dawn|at dawn|just before sunrise|dawn|~early dawn",
    "dark": "dark|dark with no lights|dark with no artificial lighting|after dark on an unlit road|dark and not lighted|dark, unlighted|dark with no streetlights|dark and unlit|dark, there were no streetlights|~nighttime without street lights|~pitch dark",
    "dark_lit": "dark with overhead lighting|dark with street lights|lit by overhead lights|dark with artificial lighting|dark and lighted|dark with artificial illumination|dark with streetlights|dark, but lighted|dark but lighted|dark with lights|illuminated|~night, with street lamps lit|~dark though the street lights were on",
}
WEATHER = {
    "clear": "clear|clear skies|with no adverse weather|without precipitation|good|clear|clear|clear with no adverse conditions|clear and sunny|~sunny|~fair",
    "cloudy": "cloudy|cloudy skies|mostly cloudy|overcast skies|cloudy|overcast|partly cloudy|~gray and clouded",
    "rain": "raining|rain|light rain|heavy rain|showers|pouring rain|raining|rainy|raining lightly|raining heavily|~wet with a steady rain|~drizzling",
    "snow": "snowing|snow|light snow|heavy snow|blowing snow|snowing|snowing lightly|~snowy with flakes falling",
    "sleet": "sleeting|sleet|a wintry mix|sleeting|~freezing rain and sleet",
    "fog": "foggy|fog|dense fog|hazy|foggy|~misty with fog",
}
SURFACE = {
    "dry": "dry|dry and level|free of moisture|dry|dry|~dry and clean",
    "wet": "wet|wet with rain|rain soaked|wet and slippery|moist|wet|wet|wet from rain|~damp|~slick and wet",
    "snow": "snow covered|snowy|covered in snow|slushy|snow-covered|covered with snow|~under packed snow",
    "ice": "icy|covered with ice|glazed with ice|slippery with ice|icy|ice covered|~iced over|~slick with ice",
}
