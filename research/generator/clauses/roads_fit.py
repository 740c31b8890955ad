"""What turning vehicles leave, enter or obey, a street, a driveway, a signal: words that suit a crash's roads."""

from __future__ import annotations

from research.generator.crash.compass_ties import VAGUE
from research.generator.crash.world import Actor, Crash
from research.generator.phrase_labels import has
from sgcad_core.kinds import DRIVEWAY, FOUR, INTERSECTIONS


def fits_roads(text: str, crash: Crash, actor: Actor) -> bool:
    """Whether what the words say of driveways, streets, signs and signals is true of these roads and of an
    actor that comes to them."""
    controls, met = {leg.control for leg in crash.legs}, crash.leg(actor.leg)
    if has(text, "signal") and "signal" not in controls:
        return False
    if has(text, "sign") and (met is None or met.control != "stop"):
        return False
    if crash.layout != FOUR and has(text, "four_legs"):
        return False
    if crash.layout == DRIVEWAY:
        return not has(text, "street")
    if crash.layout not in INTERSECTIONS:
        return True
    stops = bool(controls & {"stop", "flashing", "signal"})
    return not has(text, DRIVEWAY) and (not has(text, "stop_line") or stops)


def facts_of_words(text: str, crash: Crash) -> set[str]:
    """Facts of the roads that the words tell beside their own: that there is a driveway, a signal or a stop sign."""
    found = {"layout"} if crash.layout == DRIVEWAY and has(text, "leaves") else set()
    if has(text, "sign") and any(leg.control == "stop" for leg in crash.legs):
        found |= met("sign", crash)
    return found | (met("light", crash) if has(text, "signal") else set())


def met(key: str, crash: Crash) -> set[str]:
    """Facts that waiting for a "light" tells, or for a "sign", which other legs may have or not."""
    if key == "sign":
        return {"control", f"{VAGUE}.control"}
    return {"control"} if all(leg.control == "signal" for leg in crash.legs if leg.lanes_in) else set()
