"""The words around a verb of hitting: voice, near misses, objects, where, with what, by whom. Patterns only."""

from __future__ import annotations

import re

from sgcad_core.narrative.zones import AREA

PASSIVE = re.compile(
    r"\b(?:was|were|is|are|been|being|be|got|gets)(?: (?:\w+ly|then|also|first|again|"
    r"subsequently))*\s*$",
    re.I,
)
NEAR_MISS = re.compile(
    r"\b(?:(?:avoid\w*|prevent\w*|without|about to|keep from|instead of|would(?: not)?(?: have)?|(?:could|might|"
    r"may) (?:have|not)(?: have)?|almost|"
    r"nearly|narrowly|not|never)(?: (?:being|be|been|get|getting|the|a|an|any|making|coming|into|from|having|to|"
    r"both|another|further))*|"
    r"to(?: (?:avoid|be|have|get|being|been|not|prevent|make|come|in|into))*)\s*$", re.I)  # fmt: skip
TO_HIT = re.compile(
    rf"\b(?:caus\w+ (?:the )?(?:(?:{AREA}) of )?(?:\w+ )?|proceed\w* |continu\w* |went on |return\w+ |"
    r"spin |forc\w+ (?:\w+ )?)to\s*$",
    re.I,
)
ACTIVE_OBJECT = re.compile(
    rf"^(?:\W*(?:with|into|against|to|onto|upon|by|and|the|in|at|on|occurr\w+|was|made|contact|first|then|head-on|"
    rf"along|near)\b)*\W*"
    rf"(?:(?P<area>{AREA})\s+(?:of|on|to|area of|portion of)\s+(?:the )?)?(?:the driver of )?(?P<v>V\d+)",
    re.I)  # fmt: skip
WITH_ITS = re.compile(rf"\bwith (?:its|it's|the|his|her|their)(?: own)? (?P<area>(?>{AREA}))\b(?! of)", re.I)
ON_THE = re.compile(
    rf"\b(?:in|on|at|to|near|along|into|onto|from|across|against|toward)(?: to)? (?:the |its |his |"
    rf"her |their )?(?:\w+ (?:of|on) the )?(?P<area>{AREA})\b",
    re.I,
)
BY = re.compile(rf"\bby\W+(?:the |a )?(?:(?P<area>{AREA}) of (?:the )?)?(?:the driver of )?(?P<v>V\d+)", re.I)
THE_AREA = re.compile(rf"^\W*(?:with |into |to |against )?(?:the|his|her|their) (?P<area>{AREA})\b(?! of)", re.I)
PRONOUN_OBJECT = re.compile(r"^\W*(?:with |into )?(?:it|him|her|them|each other|one another)\b", re.I)
OBJECTS = (
    "pole", "tree", "curb", "fence", "guardrail", "guard rail", "sign", "mailbox", "barrier", "wall", "embankment",
    "post", "hydrant", "building",
    "house", "median", "bridge", "ditch", "culvert", "rock", "boulder", "bush", "shrub", "deer", "animal", "cable",
    "pillar", "abutment",
    "delineator", "island", "railing", "barricade", "dumpster", "snowbank", "snow bank", "ground", "trailer", "parked",
    "pedestrian",
    "bicycle", "bicyclist", "cyclist", "signal", "light standard",
)  # fmt: skip
OBJECT = re.compile(rf"^[^.;]{{0,70}}?\b(?P<object>{'|'.join(OBJECTS)})s?\b", re.I)
THING_WAS = re.compile(
    rf"(?:^|[;,] |\band )(?:an?|the|two|some) (?:[\w-]+ ){{0,3}}?(?P<object>{'|'.join(OBJECTS)})s?"
    r"(?: (?!V\d|(?:and|but|then|which|that|when|where)\b)[\w-]+){0,6}? (?:was|were|is|are|got)"
    r"(?: \w+ly| then| also)*\s*$", re.I)  # fmt: skip
DAMAGED = re.compile(
    rf"^\W*(?:the )?(?P<area>{AREA}) of (?:the )?V\d+ (?:was|were|is) (?:\w+ed|hit|struck) (?:when|as)\b", re.I
)
CAUSED = re.compile(rf"\bcaus\w+ (?:the )?(?:(?P<area>{AREA}) of )?(?P<v>V\d+) to\s*$", re.I)
ASIDE = re.compile(r", (?:which|that|who) (?:was|were|is|had)\b[^,.;]{0,60},(?= (?:in|on|at|with) )", re.I)
CLAUSE_END = re.compile(
    r"[;.]|, (?:and|then|which|while|causing)\b|\band (?:then|came|the)\b|\bcausing\b|"
    r"\bbefore\b|\bafter\b|\bpushing\b|\bthen\b|\bas\b (?:it|V\d)",
    re.I,
)
BETWEEN = re.compile(
    rf"\b(?:impact|collision|contact|crash)\b[^.;]{{0,40}}?\bbetween (?:the )?(?:(?P<a1>{AREA}) of )?(?P<v1>V\d+)\b"
    rf"[^.;]{{0,20}}?\b(?:and|with) (?:the )?(?:(?P<a2>{AREA}) of )?(?P<v2>V\d+)", re.I)  # fmt: skip
BOTH_PARTS = re.compile(
    rf"(?<!in )\b(?P<a1>{AREA}) of (?P<v1>V\d+) (?:and|with) (?:the )?(?P<a2>{AREA}) of (?P<v2>(?!(?P=v1)\b)V\d+) "
    rf"(?:\w+ )?(?:collid|contact|made contact|met|impact|struck)", re.I)  # fmt: skip
PUSHED = re.compile(
    rf"(?:\bpush\w*|\bforc\w*|\bknock\w*|\bpropel\w*) (?P<v1>V\d+) (?:\w+ ){{0,2}}?into (?:the )?(?:(?P<a2>{AREA}) "
    rf"of )?(?P<v2>V\d+)|"
    rf"\b(?P<v3>V\d+) (?:was|is|were) (?:then )?(?:push|forc|knock|propel)\w* (?:\w+ ){{0,2}}?into (?:the "
    rf")?(?:(?P<a4>{AREA}) of )?(?P<v4>V\d+)", re.I)  # fmt: skip
AGAINST = re.compile(
    rf"\b(?P<a1>{AREA}) of (?P<v1>V\d+) (?:against|to|with|into|and|on) (?:the )?(?P<a2>{AREA}) of (?P<v2>V\d+)",
    re.I)  # fmt: skip
OF_BOTH = re.compile(rf"\b(?P<area>{AREA}) of (?:both|the two|the) vehicles\b", re.I)
PAIRED = re.compile(rf"\b(?P<a1>{AREA})[ -](?:to|against|into|with)[ -](?:the )?(?P<a2>{AREA})\b", re.I)
