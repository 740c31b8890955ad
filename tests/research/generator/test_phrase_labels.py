# ruff: noqa: E501 - one phrase a line
"""Labels of phrases agree with the words: phrases that a person read, and what that person found in them."""

import pytest

from research.generator import phrase_labels, records

FILES = ("codes", "contact", "critical", "motion", "noise", "road", "scene", "turning", "words")

READ: list[tuple[str, str, str, str]] = [
    # file and list, phrase without labels, labels of the whole, labels of some alternative
    ("contact IMPACT", "{S} crashed into {T}, {sa} [in|]to {ta}", "", ""),
    ("contact IMPACT", "{S} ran its {sa} [up against|right into|hard into] {T}'s {ta}", "", ""),
    ("contact IMPACT", "{S}'s {sa} went [through|deep into|a foot into|several inches into] the {ta} of {T}", "", ""),
    ("contact IMPACT", "The [blow|impact|hit] came from {S}, whose {sa} [struck|caught|crushed] the {ta} of {T}", "", ""),
    ("contact IMPACT", "{T} [could not|was unable to] [evade|avoid] {S}, which [hit|struck] it on the {ta} with its {sa}",
     "struck", ""),
    ("contact IMPACT", "{T} [sustained|suffered] [an impact|a hit|damage] to the {ta} [from|by] {S}, which was damaged on "
     "the {sa}", "struck", ""),
    ("contact IMPACT", "{T}, [while still moving|which could not avoid it|unable to get clear], was [struck|hit] by the "
     "{sa} of {S} [in|on] its {ta}", "struck", "manned"),
    ("contact IMPACT", "The driver of {T} was [struck|hit] [in|on] the {ta} of [his|her] vehicle by the {sa} of {S}",
     "struck manned", ""),
    ("contact IMPACT", "[Striking|Hitting] the {ta} of {T}, {S} was damaged on its {sa}", "place", "unled"),
    ("contact IMPACT", "Hard on the {ta} of {T} [came|crashed|landed] {S}, {sa} first", "place", ""),
    ("contact IMPACT", "[Hard|Full|Square] against the {ta} of {T} [ran|drove|crashed] the {sa} of {S}", "place", ""),
    ("contact IMPACT", "To the {ta} of {T} [came|slid|skidded] the {sa} of {S}, [hard|with force|fast]", "place", ""),
    ("contact IMPACT", "The impact [to|on] the {ta} of {T} was by {S}, with its {sa}", "place", ""),
    ("contact IMPACT", "The {sa} of {S} [met|found|caught|reached|got] the {ta} of {T}", "", "mutual"),
    ("contact SWIPE", "Along the {ta} side of {T} [scraped|dragged|slid|rubbed] the {sa} side of {S}", "place", ""),
    ("contact IMPACT_BARE", "This brought {S} into [contact|collision] with {T}", "mutual", ""),
    ("contact IMPACT_BARE", "{S} did not manage to [stop|avoid {T}], and [hit|struck] {T}", "", ""),
    ("contact THEN", "[As a result|From the impact], {S} was forced into {T}, its {sa} striking the {ta} of {T}", "again",
     ""),
    ("contact THEN", "{T} was then [struck|hit] [in|on] the {ta} by the {sa} of {S}", "struck", ""),
    ("contact THEN", "The second event was {S} [hitting|striking] {T}, {sa} to {ta}", "", ""),
    ("contact THEN", "{T} was the next [to be hit|vehicle struck], {S}'s {sa} [crashing|going|slamming] into its {ta}",
     "struck", ""),
    ("contact THEN_REAR", "{S}'s front [end |bumper |]was [shoved|pushed|driven|forced] into {T}'s rear", "again", ""),
    ("contact THEN_REAR", "{S} slid ahead until its front hit {T}'s rear", "", ""),
    ("contact REST", "{V} was pushed {any8} into [the curb|a pole|a ditch|the median]", "moved_v median", ""),
    ("contact REST", "Both vehicles remained in contact and moved {any8}", "two", ""),
    ("contact REST", "In the ditch {V} [stopped|came to rest|rolled over]", "", ""),
    ("contact AVOID", "Neither driver attempted any [evasive|avoidance] actions", "two", ""),
    ("contact AVOID", "{V}'s driver [hit|mashed|pushed|pumped] the brake [pedal |]hard", "", ""),
    ("contact TAILS", "and then [both|the two] [came to a stop|separated|came apart|bounced apart]", "both", ""),
    ("contact TAILS", ", [jolting|shaking up|startling] [the occupants|those inside|both drivers]", "", "both"),
    ("contact LEADS", "[Following|After] this", "", ""),
    ("contact AREA.front", "front wall of the cab", "body", ""),
    ("contact AREA.left", "left roof edge", "body", ""),
    ("contact AREA.back", "rear brake lights", "", ""),
    ("critical CRITICAL.rear_end", "{W} had [come to a stop|pulled up|halted], a fact that the driver of {V} [missed|did "
     "not register|failed to appreciate]", "", "stopped"),
    ("critical CRITICAL.rear_end", "{V}, [speeding|going well over the limit|driven too fast], [came up behind|closed "
     "rapidly on] {W}", "", ""),
    ("critical CRITICAL.left_opposite", "[On a green light|On the green signal|At the intersection], {V} turned left "
     "[into|across] the path of {W}", "", "signal street"),
    ("critical CRITICAL.left_opposite", "Having moved up into the intersection to wait, {V} then turned left before {W} "
     "had passed", "street", ""),
    ("critical CRITICAL.left_opposite", "{V} dashed left ahead of oncoming {W}", "", ""),
    ("critical CRITICAL.turn_left", "{V} [drove|moved|proceeded] from the stop sign and turned left [into|onto] the "
     "road[way|]", "sign street stop_line", ""),
    ("critical CRITICAL.turn_left", "{V} pulled out [of the driveway |]to turn left [in front of|into the path of] {W}",
     "", "driveway leaves"),
    ("critical CRITICAL.backing", "{V} [was backing|backed] out of [the|a] driveway [into|in] the path of {W}",
     "driveway leaves", ""),
    ("critical CRITICAL.parked", "[While looking down|Distracted|Looking away], the driver of {V} [drifted|moved] to the "
     "right", "drifts", ""),
    ("critical CRITICAL.parked", "{V} was too far to the right[ in its lane|]", "", ""),
    ("critical CRITICAL.parked", "The operator of {V} did not perceive {W} parked by the curb", "", ""),
    ("critical CRITICAL.parked", "{V} lacked the [room|width|clearance] to get by {W}", "", ""),
    ("turning STRAYS", "{V} had [stopped|been] on the {aside} shoulder and [pulled|moved|came] {turn} into the lane of "
     "{W}", "shoulder", ""),
    ("motion WHY.sign", "in obedience to the stop sign", "sign street stop_line", ""),
    ("motion INTENT.turn_left", "with the intention of turning left", "", ""),
    ("motion APPROACH", "{Vf} approached {dir} [in the {lane}|on {road}|along {road}]", "", ""),
    ("codes OTHER_FRAMES", "A witness [stated|said|reported] that {W} {did}", "third", ""),
    ("codes MOVEMENT.lane_change_left", "changing lanes", "", ""),
    ("codes MOVEMENT.lane_change_left", "changing lanes to the left", "side", ""),
    ("codes CRASH_TYPE.left_lateral", "turn into path, from the side", "turner", ""),
    ("codes CRASH_TYPE.crossing", "straight paths, intersecting", "", ""),
    ("noise TOW", "Only {V} [required towing|needed a wrecker|was hauled away]; {W} [left under its own power|was still "
     "drivable]", "two", ""),
    ("noise INTERVIEW", "Not [seeing|noticing|expecting] {W}, {he} [took no evasive action|had no time to be scared|was "
     "caught off guard]", "two", ""),
    ("noise INTERVIEW", "The driver's spouse stated that {he} [did not remember the crash|had been up since early "
     "morning|was still in the hospital]", "third", ""),
    ("scene OPENING_PLAIN", "[Residents|Neighbors|People living] along {road} heard the [bang|boom|crash]", "", ""),
    ("scene ROAD", "What the [limit|sign|law] allowed [was|is] {lim}", "", ""),
    ("scene WEATHER.snow", "snow coming down sideways", "", ""),
    ("scene WEATHER.clear", "sunny skies", "sunny bright", ""),
    ("scene OPENING_PLAIN", "[In|During] the {tod}, the vehicles [collided|crashed] on {road}", "two one_road", ""),
    ("scene SURFACE.wet", "wet from rain", "rained", ""),
    ("scene SURFACE.wet", "drying, still damp", "", ""),
]  # fmt: skip

MISLABELLED: list[tuple[str, str, str, str]] = [
    ("contact IMPACT", "Not only the {ta} of {T}, which was struck, but also the {sa} of {S} was damaged", "struck", ""),
    ("contact IMPACT", "[Having|With] no way out, {T} had the {sa} of {S} [come|crash|drive] into its {ta}", "struck", ""),
    ("contact THEN", "The [first|initial] impact made {S} [hit|strike|run into] the {ta} of {T} with its {sa}", "again", ""),
    ("contact THEN_REAR", "The impact [pushed|forced|drove] {S} into the [rear|back] of {T}", "again", ""),
    ("scene OPENING_JUNCTION", "[Impact|Contact] between the vehicles [was made|came|occurred] [at|in] {jn} of {road} "
     "[and|with] {road2}", "two", ""),
    ("contact THEN_REAR", "{S} was rammed into the back of {T}", "again", ""),
    ("critical CRITICAL.parked", "With an [empty|unattended] vehicle, {W}, on the right, {V} should have moved over but "
     "did not", "", ""),
    ("motion WHY.light", "for lights that were red", "signal", ""),
]  # fmt: skip
"""Phrases whose labels a pattern once got wrong. Rows of the present weights were made with them: they are to be mended
with the next training."""


def found(place: str, text: str) -> tuple[set[str], set[str]]:
    """Labels of a phrase and of its alternatives, by its words."""
    name, heading = place.split()
    for phrases in records.records(name)[heading].values():
        for phrase in phrases:
            if phrase_labels.plain(phrase_labels.marked(phrase.text)) == text:
                return set(phrase.whole), set(phrase_labels.inline(phrase.text))
    raise AssertionError(f"{place} has no phrase {text!r}")


@pytest.mark.parametrize(("place", "text", "whole", "some"), READ, ids=lambda value: value[:40])
def test_labels_say_what_a_reader_finds(place: str, text: str, whole: str, some: str) -> None:
    assert found(place, text) == (set(whole.split()), set(some.split()))


@pytest.mark.xfail(strict=True, reason="rows of the present weights were made with these labels")
@pytest.mark.parametrize(("place", "text", "whole", "some"), MISLABELLED, ids=lambda value: value[:40])
def test_labels_that_wait_for_the_next_training(place: str, text: str, whole: str, some: str) -> None:
    assert found(place, text) == (set(whole.split()), set(some.split()))
