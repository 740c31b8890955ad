"""What each sentence of a crash report is for, by keywords.

About half of a report is noise for a scenario (injuries, interviews, codes), and the noise is full of
vehicle names, directions and verbs; a role lets readers leave it out. Knows no vehicle and no road.
"""

from __future__ import annotations

import re
from typing import Literal

Role = Literal[
    "opening", "road", "conditions", "approach", "avoidance", "impact", "rest", "towing", "restraint", "injury",
    "interview", "health", "codes", "factors", "police", "other",
]  # fmt: skip

CRASH_ROLES: frozenset[Role] = frozenset({"opening", "road", "conditions", "approach", "avoidance", "impact", "rest"})
"""Roles that tell the crash itself; the others are noise, at best a second witness."""

_HIT = (
    r"struck|strikes?|striking|impact(?:ed|s|ing)|contact(?:ed|s|ing)|hits?|hitting|collid\w+|rear-end(?:ed|s|ing)?|"
    r"side-?swip\w+|side-?slap\w*|(?:made|makes|making|came in|came into) contact|t-boned|broadsided|clipped|rammed|"
    r"bumped|"
    r"(?:slid|ran|drove|crashed|skidded|slammed|plowed|smashed|backed|rolled|went) into (?=(?:the |its )?(?:front|"
    r"rear|back|left|right|"
    r"side|passenger|driver's)\b|(?:the )?V\d|it\b|him\b)"
)
HIT = re.compile(rf"\b(?:{_HIT})\b", re.I)
_VEHICLE_BEFORE_HIT = re.compile(
    rf"\b(?:V\d+|vehicles?|front|rear|side|back|bumper)\b.*\b(?:{_HIT})\b|\b(?:{_HIT})\b.*\bV\d+", re.I
)
_COUNTERFACTUAL = re.compile(
    r"\b(?:avoid(?:ed|ing)?|prevent(?:ed|ing)?|without|prior to|before|(?:would|could|might|may) (?:have|not)|"
    r"about to) "
    r"(?:\w+ ){0,4}?(?:contact|impact|collision|striking|being struck|hitting|colliding)",
    re.I,
)

_RULES: tuple[tuple[Role, str], ...] = (
    ("codes", r"critical (?:pre-?\s?crash |pre-?\s?crsh |crash )?(?:event|reason)|\bcritical reason|"
              r"reason for (?:the|this) critical|"
              r"first harmful event"),
    ("factors", r"associated factors?|associative|(?:was|were|been) coded|\bcoded (?:to|for|as)\b|"
                r"factors? (?:was|were)|"
                r"contribut(?:ed|ing) to (?:the|this) crash|non-driving activit"),
    ("police", r"\b(?:alcohol|drugs?|citation|cited|summons|arrest\w*|BAC|toxicology|ordered no tests?|"
               r"intoxicat\w+)\b"),
    ("towing", r"\b(?:towed|tow(?:ed)? due|driven (?:away )?from the scene|disabling|"
               r"drove (?:away )?from the scene)\b"),
    ("interview", r"\b(?:stated|states|reported(?!ly)|said|says|advised|claimed|told|recalled|remember\w*|"
                  r"interview\w*|witness\w*|"
                  r"according to|estimated|mentioned|indicated|admitted|thought|believed|noticed that|explained|"
                  r"surrogate|I spoke|declined to|statement|heard|does not know|did not know|unable to recall)\b"),
    ("health", r"\b(?:medications?|prescription|lenses|glasses|eyeglasses|myopi\w*|fatigue\w*|hours of sleep|"
               r"slept|good health|"
               r"familiar(?:ity)?|(?:on (?:his|her|the|their) way|en ?route) (?:to|home|from)|drives this|health|"
               r"trip (?:plan|from)|work stress|diabet\w*|odometer)\b"),
    ("injury", r"\b(?:injur\w+|transported|hospital\w*|trauma|ambulance|airlifted|treated|fatal\w*|deceased|died|"
               r"complain\w*|pronounced|medical (?:facility|center)|pregnant)\b"),
    ("restraint", r"\b(?:seat ?belts?|belted|unbelted|restrain\w+|air ?bags?|child seat|"
                  r"lap (?:and shoulder )?belt|safety seat|"
                  r"three-point|shoulder belt)\b"),
    ("restraint", r"\bwas (?:being )?(?:driven|operated) by\b|\b(?:year|yr)s?[- ]old\b(?=.*\b(?:driver|male|"
                  r"female|man|woman)\b)"),
)  # fmt: skip
_NOISE = tuple((role, re.compile(pattern, re.I)) for role, pattern in _RULES)
_OPENING = re.compile(r"^(?:the|this|a|an)?\s*(?:[\w-]+[, ]+){0,6}?(?:crash|collision|accident|event|"
                      r"incident)\b.{0,60}?"
                      r"\b(?:occurr?ed|took place|happened|involv\w+)\b|"
                      r"^it (?:occurred|took place|happened)\b", re.I)  # fmt: skip
_REST = re.compile(r"\b(?:came? to (?:a |its |their |it's )?(?:final |complete )?(?:rest|stop)|"
                   r"final(?:ly)? rest\w*|comes? to (?:final )?rest|"
                   r"at (?:final )?rest|rolled over|(?:rotat|spun|spin)\w* .{0,40}degrees|(?:after|"
                   r"following) (?:the )?impact)\b", re.I)  # fmt: skip
_AVOID = re.compile(r"\b(?:evasive|avoid(?:ance|ed|ing)?|brak(?:ed|ing)|swerv\w+|steer(?:ed|ing)|skid\w*)\b", re.I)
_MOTION = re.compile(
    r"\b(?:travel\w*|proceed\w*|driving|heading|headed|going|facing|stopped|stopping|parked|turn(?:ed|ing|s)|"
    r"mak(?:e|es|ing) an? (?:left|right|u)|made an? (?:left|right|u)|approach\w*|enter(?:ed|ing|s)|exit(?:ed|ing|"
    r"s)|cross(?:ed|ing|es)|"
    r"drove (?:across|into|over|off|left|through|onto|straight|out)|"
    r"drift\w*|veer\w*|chang(?:ed|ing) lanes?|pass(?:ed|ing)|merg\w+|negotiat\w+|lost control|pull(?:ed|ing)|"
    r"back(?:ed|ing)|"
    r"attempt\w*|wait\w*|depart\w*|ran (?:off|through|the)|slow(?:ed|ing)|accelerat\w+|decelerat\w+|start\w*|"
    r"slid(?! (?:sideways )?(?:to|into))|overtak\w+|overtook|execut\w+|perform\w+|(?:moved|went) (?:left|off|over|"
    r"across)|"
    r"began|ahead of|behind|fail\w* to|(?:north|south|east|west)bound)\b", re.I)  # fmt: skip
_ACTOR = re.compile(
    r"\b(?:V\d+|both (?:vehicles|drivers)|vehicles?|driver|it|he|she|they|"
    r"the (?:other )?(?:car|truck|"
    r"van|bus|pickup))\b",
    re.I,
)
_CONDITIONS = re.compile(r"\b(?:daylight|dark|dusk|dawn|weather|clear|cloudy|raining|rainy|rain|snow\w*|sleet\w*|"
                         r"fog\w*|wet|dry|icy|"
                         r"atmospheric|adverse|lighted|unlighted|illuminat\w+|streetlights?|sunny|overcast|"
                         r"weekday|weekend)\b", re.I)  # fmt: skip
_ROAD = re.compile(r"\b(?:road(?:way|s|ways)?|lanes?|intersection|speed limit|grade|median|curv\w+|divided|"
                   r"undivided|highway|street|"
                   r"trafficway|shoulder|level|straight|stop sign|traffic (?:control|signal|light)s?|controlled|"
                   r"curb)\b", re.I)  # fmt: skip


_DRIVEN = re.compile(
    r"\bV\d+\b[^.]{0,160}?\b(?:was|were|had been|been|is) (?:\w+ )?(?:travel\w+|stopped|parked|(?:north|south|east|"
    r"west)bound|turning|"
    r"attempting|proceeding|heading|driving|exiting|approaching|making|backing|slowing|stationary|in the (?:\w+ "
    r"){0,3}lane)\b", re.I)  # fmt: skip


_ACTED = re.compile(
    r"^(?:the (?:driver|operator) of )?V\d+\b[^.;]*?\b(?:thought|believed|estimated)\b[^.;]*?\b(?:and|so|then) "
    r"(?:\w+ )?(?:turned|made an? (?:left|right|u)|pulled (?:out|into)|proceeded|entered|drove into|changed lanes)\b",
    re.I)  # fmt: skip


def role_of(text: str) -> Role:
    """The role of one normalized sentence. A sentence of two roles gets the one that misleads least."""
    if _OPENING.search(text):
        return "opening"
    noise = _noise(text)
    if noise in ("restraint", "injury", "health") and _DRIVEN.search(text):
        return "impact" if is_impact(text) else "approach"
    if noise == "interview" and _ACTED.search(text):
        return "approach"
    if noise in ("restraint", "health") and is_impact(text):
        return "impact"
    if noise:
        return noise
    if is_impact(text):
        return "impact"
    if _REST.search(text):
        return "rest"
    return _scene(text)


def is_impact(text: str) -> bool:
    """Whether a sentence tells that vehicles touched (not that they nearly did)."""
    bare = _COUNTERFACTUAL.sub(" ", text)
    return bool(_VEHICLE_BEFORE_HIT.search(bare))


def _noise(text: str) -> Role | None:
    return next((role for role, pattern in _NOISE if pattern.search(text)), None)


def _scene(text: str) -> Role:
    """Motion, road or conditions: whatever stays when the noise is gone."""
    named = re.search(r"\bV\d+\b|\bboth (?:vehicles|drivers)\b", text)
    if named and _AVOID.search(text) and not re.search(r"\btravel(?:ing|ling|ed)\b", text):
        return "avoidance"
    if _MOTION.search(text) and (named or (_ACTOR.search(text) and not _ROAD.match(text.split(" ", 1)[-1]))):
        return "approach"
    conditions, road = len(_CONDITIONS.findall(text)), len(_ROAD.findall(text))
    if conditions and conditions >= road:
        return "conditions"
    if road:
        return "road"
    return "other"
