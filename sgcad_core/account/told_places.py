"""Stated places of actors: at a stop sign, at a signal that shows something, in a roundabout, on foot on one leg.

Matches words in the narrative's sentences and compares them with the places in the scenario.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.execution.signals import TURNED_S
from sgcad_core.geometry.distances import distance_to
from sgcad_core.metrics.lane_places import lane_steps
from sgcad_core.metrics.rest_error import COMPASS_DEG
from sgcad_core.reading.language import rule, values
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.roads.compiled_facts import headings_agree
from sgcad_core.roads.lane_graph import Connection, edge_id
from sgcad_core.rules.lights import lights_of
from sgcad_core.rules.passages import MEANS

_AT_SIGN, _AROUND, _ON_LEG = rule("account.at_sign"), rule("account.around"), rule("account.on_leg")
_LEG_DEG = 50.0
_ON_LANE_M = 2.0
_JUST_S = TURNED_S + 2.0
"""A signal that has shown its state for no longer has just turned to it."""
_PARKS = ("beside", "beyond", "off")
"""Places of a motion that are no lane for cars."""
_APPROACH_S = 2.0
"""Time before its first contact in which a circulating vehicle must be on the circle."""


def told_place_items(made: ExecutedCase) -> Iterator[Item]:
    """One item per stated place, for its first mention."""
    found: dict[str, Item] = {}
    for sentence in made.reading.sentences:
        if sentence.role in STORY_ROLES:
            for item in (*_at_sign(made, sentence), *_around(made, sentence), *_on_leg(made, sentence)):
                found.setdefault(f"{item.field} {item.subject} {item.value}", item)
    yield from found.values()


def _item(has: bool, sentence: Sentence, about: tuple[str, str, str], text: str, why: str) -> Item:
    what, subject, value = about
    return Item(
        kind="has" if has else "lacks", field=f"text.{what}", subject=subject, value=value, text=text,
        reason="" if has else why, start=sentence.start, end=sentence.end,
    )  # fmt: skip


# ------------------------------------------------------------------ signals
def signal_items(made: ExecutedCase) -> Iterator[Item]:
    """What the signal before a vehicle is told to show at the contact, and that it has turned to it just before. Not of
    a near crash, nor on a real place, whose lanes the scenario's writer does not name."""
    contact = made.execution.contact
    told = {who: state for who, state in made.reading.signals.items() if who in made.tracks}
    if contact is None or made.network.place is not None or not told:
        return
    lights = lights_of(made.graph, made.scenario.xosc)
    for who, state in told.items():
        link = _signal_ahead(made, who)
        shown = lights.at(link, contact.t_s) if lights and link else None
        why = (
            f"it shows {shown.state}" if shown else "no signal before it shows anything" if link else "it has no signal"
        )
        seen = shown.state if shown else None
        yield made.item(seen == state, f"vehicles.{who}.signal", state, seen, why=why)
        if f"vehicles.{who}.signal_turned" in made.told:
            just = shown is not None and shown.since_s <= _JUST_S
            yield made.item(
                just, f"vehicles.{who}.signal_turned", True, why="its signal does not turn before the contact"
            )


def _signal_ahead(made: ExecutedCase, who: str) -> Connection | None:
    """The connection with a signal by which a vehicle means to leave its road."""
    behavior = made.scenario.behavior
    actor = next((a for a in behavior.actors if a.id == who), None) if behavior else None
    if actor is None or actor.direction is None:
        return None
    links = [c for c in made.graph.leaving(edge_id(actor.road, actor.direction)) if c.light]
    meant = MEANS.get(actor.maneuver or "", "through")
    return next((c for c in links if c.direction == meant), next(iter(links), None))


# ------------------------------------------------------------------ parking
def parking_items(made: ExecutedCase) -> Iterator[Item]:
    """A vehicle of which no more is told before the first contact than that it leaves a parking place starts beside the
    lanes."""
    before = [act for act in made.reading.timeline if act.phase == "before" and not act.meant]
    last = {act.actor: act for act in before}
    for act in last.values():
        if act.kind == "leaving_parking" and act.actor in made.tracks:
            starts = lane_steps(made.graph, made.crash.paths[act.actor].pose[:2]).places[0]
            field, why = f"vehicles.{act.actor}.leaves_parking", "it starts in a lane, not in a parking place"
            found = made.item(starts in _PARKS, field, True, starts, why=why)
            yield found.model_copy(update={"start": act.start, "end": act.end})


# ------------------------------------------------------------------ signs
def _at_sign(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """A vehicle that stops at a sign comes on a leg with a sign."""
    spec, behavior = made.network.spec, made.scenario.behavior
    for match in _AT_SIGN.finditer(sentence.text):
        actor = (
            next((a for a in behavior.actors if a.id == made.reading.actor(match["who"])), None) if behavior else None
        )
        road = next((r for r in spec.roads if actor and r.id == actor.road), None) if spec else None
        if spec is None or actor is None or road is None:
            continue
        end = road.to_node if actor.direction == "forward" else road.from_node
        control = next(node.control for node in spec.nodes if node.id == end)
        signed = control == "all_way_stop" or (control in ("stop", "yield", "flashing") and road.minor)
        text = f"{actor.id} at its {match['sign']}"
        about = ("sign", actor.id, match["sign"])
        yield _item(signed, sentence, about, text, f"the road {road.id} on which it comes has no sign")


# ------------------------------------------------------------------ roundabouts
def _around(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """A circulating vehicle is on the circle before the first contact, in the stated lane."""
    for match in _AROUND.finditer(sentence.text):
        if match["who"] in made.tracks and made.graph.circles:
            lane = _circle_lane(made, match["who"])
            inner = values("circle_lane").get((match["lane"] or "").lower())
            fits = lane is not None and (inner is None or lane[0] == (lane[1] if inner == "inner" else 1))
            seen = f"it is in lane {lane[0]} of {lane[1]} around" if lane else "it is not on the circle"
            about = ("around", match["who"], match["lane"] or "circulates")
            yield _item(fits, sentence, about, f"{match['who']} in the roundabout{f', {inner} lane' if inner else ''}",
                        f"{seen} in the {_APPROACH_S:.0f} s before its contact")  # fmt: skip


def _circle_lane(made: ExecutedCase, who: str) -> tuple[int, int] | None:
    """(lane from the outer edge, lanes) of the circle in which a vehicle comes to the contact; None: in none."""
    path = made.crash.paths[who]
    hit = made.crash.first_of(who)
    early = max(0, int(np.searchsorted(path.t_s, float(path.t_s[hit]) - _APPROACH_S)))
    at = path.pose[early : early + 1, :2]
    lanes = [
        (float(distance_to(lane.shape, at)[0]), place, len(edge.car_lanes))
        for edge in made.graph.edges.values() if made.graph.is_around(edge)
        for place, lane in enumerate(edge.car_lanes, 1)
    ]  # fmt: skip
    best = min(lanes, default=None)
    return (best[1], best[2]) if best and best[0] <= _ON_LANE_M else None


# ------------------------------------------------------------------ on foot
def _on_leg(made: ExecutedCase, sentence: Sentence) -> Iterator[Item]:
    """A pedestrian or cyclist on a stated leg of the junction is struck there."""
    match = _ON_LEG.search(sentence.text)
    walker = next((name for name in made.tracks if name[0] in "PB"), None)
    hub = _hub(made)
    if not match or walker is None or hub is None:
        return
    at = made.crash.paths[walker].pose[made.crash.first_of(walker), :2]
    bearing = math.atan2(float(at[1]) - hub[1], float(at[0]) - hub[0])
    wanted = match["way"].upper()[0]
    fits = headings_agree(bearing, math.radians(90.0 - COMPASS_DEG[wanted]), _LEG_DEG)
    about = ("leg", walker, wanted)
    yield _item(fits, sentence, about, f"{walker} on the {match['way'].lower()} leg", "it is struck elsewhere")


def _hub(made: ExecutedCase) -> tuple[float, float] | None:
    """The place of the node where most edges meet."""
    counts: dict[str, int] = {}
    for edge in made.graph.edges.values():
        counts[edge.to_node] = counts.get(edge.to_node, 0) + 1
    most = max(counts, key=lambda node: counts[node], default=None)
    if most is None or counts[most] < 3:
        return None
    node = made.graph.nodes[most]
    return node.x_m, node.y_m
