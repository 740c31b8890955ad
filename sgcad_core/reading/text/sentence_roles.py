"""What each sentence of a crash report is for, by keywords.

About half of a report is noise for a scenario (injuries, interviews, codes), and the noise is full of
vehicle names, directions and verbs; a role lets readers leave it out. Knows no vehicle and no road.
"""

from __future__ import annotations

from typing import Literal

from sgcad_core.reading.language import of_role, rule

Role = Literal[
    "opening", "road", "conditions", "approach", "avoidance", "impact", "rest", "towing", "restraint", "injury",
    "interview", "health", "codes", "factors", "police", "formal", "other",
]  # fmt: skip
CRASH_ROLES: frozenset[Role] = frozenset({"opening", "road", "conditions", "approach", "avoidance", "impact", "rest"})
"""Roles that tell the crash itself; the others are noise, at best a second witness."""
STORY_ROLES: frozenset[Role] = CRASH_ROLES | {"other"}
"""Roles in which places and roads are told: those, and sentences without a word that gives them a role."""
HIT = rule("roles.hit")
_ROAD = rule("roles.road")
_BESIDE: tuple[Role, ...] = ("factors", "police", "towing", "health", "injury", "restraint")
"""Noise roles whose sentences may tell a crash, too."""


def role_of(text: str) -> Role:
    """The role of one normalized sentence. A sentence of two roles gets the one that misleads least."""
    text = rule("roles.attribution").sub("", text)
    if rule("roles.opening").search(text):
        return "opening"
    noise = _noise(text)
    if noise in ("restraint", "injury", "health") and rule("roles.driven").search(text):
        return "impact" if is_impact(text) else "approach"
    if noise in _BESIDE and (rule("roles.struck_plainly").search(text) or rule("roles.came_from").search(text)):
        return "impact" if is_impact(text) else "approach"
    if noise == "interview" and rule("roles.acted").search(text):
        return "approach"
    if noise in ("restraint", "health") and is_impact(text):
        return "impact"
    if noise:
        return noise
    if is_impact(text):
        return "impact"
    if rule("roles.rest").search(text):
        return "rest"
    return _scene(text)


def is_impact(text: str) -> bool:
    """Whether a sentence tells that vehicles touched (not that they nearly did)."""
    bare = rule("roles.counterfactual").sub(" ", text)
    return bool(rule("roles.vehicle_before_hit").search(bare))


def _noise(text: str) -> Role | None:
    return next((noise.yields["role"] for noise in of_role("noise") if noise.search(text)), None)


def _scene(text: str) -> Role:
    """Motion, road or conditions: whatever stays when the noise is gone."""
    named = rule("roles.named").search(text)
    if named and rule("roles.avoid").search(text) and not rule("roles.traveled").search(text):
        return "avoidance"
    if rule("roles.motion").search(text) and (
        named or (rule("roles.actor").search(text) and not _ROAD.match(text.split(" ", 1)[-1]))
    ):
        return "approach"
    conditions, road = len(rule("roles.conditions").findall(text)), len(_ROAD.findall(text))
    if conditions and conditions >= road:
        return "conditions"
    if road:
        return "road"
    return "other"
