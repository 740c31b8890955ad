"""Critical precrash events, as reports quote them: "this vehicle ...", "other vehicle encroachment ..."."""

from __future__ import annotations

from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import ManeuverCue, VehicleMotion


def read_critical_event(found: dict[str, VehicleMotion], told: Statement, roster: Roster) -> None:
    text = told.text.lower()
    if not rule("critical_events.event").search(text):
        return
    named = [v for v in MENTION.findall(told.text) if v in roster.ids]
    owner = named[0] if named else told.subject
    if owner not in found or rule("critical_events.uncoded").match(text):
        return
    if rule("critical_events.other_vehicle").search(text):
        _other_code(found, owner, text, told.number, roster)
    else:
        for event in of_role("own_event"):
            if code := event.search(text):
                found[owner].cues.append(
                    ManeuverCue(f"code:{event.yields['deed']}", 2, told.number, code.group(), event.id)
                )


def _other_code(found: dict[str, VehicleMotion], owner: str, text: str, number: int, roster: Roster) -> None:
    other = roster.other(owner)
    for event in of_role("others_event"):
        if not (code := event.search(text)):
            continue
        what = event.yields
        if "kin" in what:
            for me, you in ((owner, other), (other, owner)) if other else ((owner, other),):
                if me:
                    found[me].relations.append((3, what["kin"], you, "code"))
        elif who_did := (owner if what["whom"] == "self" else other):
            found[who_did].cues.append(ManeuverCue(f"code:{what['deed']}", 2, number, code.group(), event.id))
