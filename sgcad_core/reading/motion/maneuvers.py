"""One maneuver a vehicle: its pre-crash maneuver, decided from all its cues.

A turn that is told as an act beats a plan to turn; a standing vehicle stays standing unless it moved on.
"""

from __future__ import annotations

from typing import NamedTuple, cast

from sgcad_core.kinds import RAMP
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.motion_record import DRIVES, ManeuverCue, VehicleMotion
from sgcad_core.records.specs import Area, Maneuver

_SURE: tuple[Maneuver, ...] = ("parked", "backing", "u_turn")


class Decision(NamedTuple):
    """A maneuver, whether the text tells it, and the cue that decided."""

    maneuver: Maneuver
    told: bool = True
    cue: ManeuverCue | None = None


_PLAIN: tuple[Maneuver, ...] = (
    "crossing_centerline", "lane_change_left", "lane_change_right", "overtaking", "merge", "departing_road_right",
    "departing_road_left",
)  # fmt: skip


def decide(motion: VehicleMotion, hit: tuple[Area | None, ...], same_way: Maneuver = "turn_right") -> Decision:
    """The maneuver of a vehicle.

    `hit`: sides of the vehicle that were struck, in order. `same_way`: the turn that a critical event
    "turning into same direction" means.
    """
    if motion.ordered and (last := _last_state(motion)):
        return last
    for sure in _SURE:
        if cue := motion.cue(sure, 3):
            return Decision(sure, cue=cue)
    if cue := motion.cue("code:u_turn"):
        return Decision("u_turn", cue=cue)
    turn = None if changed_lanes_after_turn(motion) else _turn(motion, hit, same_way)
    if turn:
        return turn
    if _standing(motion, hit):
        return Decision("stopped", cue=motion.cue("stopped") or motion.cue("code:stopped"))
    return _moving(motion, 2 if hit[:1] == ("back",) else 3)


_STANDING = ("stopped", "parked")
_CHANGES: tuple[Maneuver, ...] = ("lane_change_left", "lane_change_right")
_SHIFTS: dict[str, Maneuver] = {"shifted_left": "lane_change_left", "shifted_right": "lane_change_right"}
"""Moves aside: a lane change of any vehicle but the report's own, which moves aside to make room."""
_OUT_OF_LANE: dict[str, Maneuver] = {
    "departed_lane_left": "lane_change_left",
    "departed_lane_right": "lane_change_right",
}
"""Out of the own lane: a change of lane, unless what is met there comes the other way."""
INTO_LANE_OF, INTO_LANE_OF_OTHER = "near_deeds.into_lane_of", "deeds.into_lane_of_other"
OUT_OF_LANE_LEFT = "deeds.departed_lane_left"
SHIFTED = tuple(f"deeds.{kind}" for kind in _SHIFTS)
"""Rules of such moves: the hand is told, that it is a change of lane is not."""
_MOVING = (
    "moved_on",
    "came_on",
    "straight",
    "leaving_parking",
    "slowing",
    "turn_left",
    "turn_right",
    "overtaking",
    *_PLAIN,
)
DEPARTURES: tuple[Maneuver, ...] = ("departing_road_left", "departing_road_right")


def _last_state(motion: VehicleMotion) -> Decision | None:
    """What a vehicle did last in an account in order: it stands, backs, or what is told since it stood."""
    acts = sorted((d for d in motion.cues if d.weight >= 3), key=lambda d: d.when)
    states = [d for d in acts if d.kind in (*_STANDING, "backing", *_MOVING, "u_turn")]
    if not states:
        return None
    last = states[-1]
    if last.kind in _STANDING:
        return Decision("parked" if last.kind == "parked" else _stands(states), cue=last)
    if last.kind in ("backing", "u_turn"):
        return Decision("backing" if last.kind == "backing" else "u_turn", cue=last)
    stood = sorted(d.when for d in states if d.kind in _STANDING)
    back = [d for d in states if d.kind == "backing" and (not stood or d.when > stood[-1])]
    if back and not any(d.when > back[-1].when and rule("deeds.forward").search(d.words) for d in states):
        return Decision("backing", cue=back[-1])
    stood = sorted([*stood, *(d.when for d in back)])
    since = [d for d in acts if not stood or d.when > stood[-1]]
    return _moving_since(motion, since)


def _stands(states: list[ManeuverCue]) -> Maneuver:
    """Parked where it was parked and is not told to have moved since, else stopped."""
    moves = [d.when for d in states if d.kind in _MOVING or d.kind == "backing"]
    parked = [d.when for d in states if d.kind == "parked"]
    return "parked" if parked and (not moves or parked[-1] > moves[-1]) else "stopped"


def _moving_since(motion: VehicleMotion, since: list[ManeuverCue]) -> Decision:
    """The maneuver of a vehicle that moves: a turn, meant before or made, else a change of lane, else straight on."""
    if motion.origin in DRIVES:  # who turns out of a driveway over a lane line changes no lanes
        since = [d for d in since if d.kind not in _CHANGES or not rule("deeds.over_lane_line").search(d.words)]
    turns = [d for d in since if d.kind in _TURNS]
    if turns and not _went_on(turns[-1], since):
        return _as_told(turns[-1])
    since = [d for d in since if d.number > turns[-1].number] if turns else since
    if not turns and (begun := _begun_turn(motion, since)):
        return _as_told(begun)
    since = _within_road(since)
    for kind in dict.fromkeys((*_CHANGES, *_PLAIN)):
        if cue := next((d for d in since if d.kind == kind), None):
            return Decision(kind, cue=cue)
    wants = [d for d in motion.cues if d.kind.startswith("want_") and d.weight >= 3]
    if wants and any(d.kind == "moved_on" and d.when > wants[-1].when for d in since):
        return _as_told(wants[-1])
    if cue := next((d for d in since if d.kind == "lane_change"), None):
        return Decision("lane_change_left", False, cue)
    if not motion.watched and (cue := next((d for d in since if d.kind in _SHIFTS), None)):
        return Decision(_SHIFTS[cue.kind], False, cue)
    slowing = next((d for d in since if d.kind == "slowing"), None)
    return Decision("slowing" if slowing else "straight", cue=slowing or (since[-1] if since else None))


def turned_before(motion: VehicleMotion, maneuver: Maneuver) -> ManeuverCue | None:
    """The turn that an account in order tells as over before what its vehicle did in the crash; None where none is."""
    turns = [d for d in motion.cues if d.kind in _TURNS and d.weight >= 3]
    if not motion.ordered or not turns or maneuver in (*_TURNS, "u_turn"):
        return None
    last = max(turns, key=lambda d: d.when)
    return last if _went_on(last, [d for d in motion.cues if d.when > last.when]) else None


def _within_road(acts: list[ManeuverCue]) -> list[ManeuverCue]:
    """Without crossings of the middle of the road that are changes of lane by the same words: "over the lane line"."""
    changes = {d.when for d in acts if d.kind == "lane_change"}
    return [d for d in acts if d.kind != "crossing_centerline" or d.when not in changes]


def _without_returns(acts: list[ManeuverCue]) -> list[ManeuverCue]:
    """Without departures of one that was back on the road: a later sentence has it leave its lane."""
    last = max(((d.number, d.at) for d in acts if d.kind in _OUT_OF_LANE), default=(-1, 0))
    return [d for d in acts if d.kind not in DEPARTURES or (d.number, d.at) >= last]


def _went_on(turn: ManeuverCue, since: list[ManeuverCue]) -> bool:
    """Whether a turn was over: it is told so, or a later sentence has the vehicle on its way again."""
    if any(d.kind == "turn_done" and d.when >= turn.when for d in since):
        return True
    later = [d for d in since if d.number > turn.number]
    return any(
        d.kind in ("straight", "overtaking", *_CHANGES) or rule("deeds.on_its_way").match(d.words) for d in later
    )


def _begun_turn(motion: VehicleMotion, since: list[ManeuverCue]) -> ManeuverCue | None:
    """A turn that was begun, broken off by a stop, and gone on with."""
    turns = [d for d in motion.cues if d.kind in _TURNS and d.weight >= 3]
    if not turns or not since or not any(d.kind == "moved_on" for d in since):
        return None
    acts = [d for d in motion.cues if d.when > turns[-1].when and d.when < since[0].when and d.kind in _MOVING]
    begun = rule("deeds.begun_turn").search(turns[-1].words)
    return turns[-1] if begun and not acts else None


def changed_lanes_after_turn(motion: VehicleMotion) -> bool:
    """Whether a turn was over before the lane change in which the vehicle crashed."""
    turns = [d.number for d in motion.cues if d.kind in ("turn_left", "turn_right") and d.weight >= 3]
    changes = [d.number for d in motion.cues if d.kind.startswith("lane_change") and d.weight >= 3]
    return bool(turns and changes) and min(changes) > max(turns)


_TURNS: tuple[Maneuver, ...] = ("turn_left", "turn_right")


def _turn(motion: VehicleMotion, hit: tuple[Area | None, ...], same_way: Maneuver) -> Decision | None:
    """A turn that was made or begun."""
    from_behind = bool(hit) and hit[0] == "back"
    for turn in _TURNS:
        if (cue := motion.cue(f"code:{turn}")) and not (from_behind and _standing(motion, hit)):
            return Decision(turn, cue=cue)
    acts = [d for d in motion.cues if d.kind in _TURNS and d.weight >= 2]
    stops = [d.number for d in motion.cues if d.kind == "stopped" and d.weight >= 2] if from_behind else []
    acts = [
        d for d in acts if not stops or d.number > max(stops)
    ]  # one struck from behind stands, unless it turns since
    if acts:
        return _as_told(max(acts, key=lambda d: d.weight))
    if cue := motion.cue("code:into_opposite"):
        return Decision("turn_left", cue=cue)
    wants = [d for d in motion.cues if d.kind.startswith("want_") and d.weight >= 2]
    if motion.has_cue("code:over_left") or motion.has_cue("crossing_centerline", 3):
        wants = []
    if wants and not from_behind and (_moved_on(motion, wants[0]) or not motion.has_cue("stopped", 2)):
        return _as_told(wants[0])
    return Decision(same_way, cue=cue) if (cue := motion.cue("code:into_same")) else None


def _as_told(cue: ManeuverCue) -> Decision:
    """The turn that a cue tells or wants."""
    return Decision(cast("Maneuver", cue.kind.removeprefix("want_")), cue=cue)


def _moved_on(motion: VehicleMotion, since: ManeuverCue) -> bool:
    return any(d.kind == "moved_on" and d.weight >= 2 and d.number >= since.number for d in motion.cues)


def _standing(motion: VehicleMotion, hit: tuple[Area | None, ...]) -> bool:
    from_behind = bool(hit) and hit[0] == "back"
    stops = [
        d
        for d in motion.cues
        if d.kind == "stopped" and d.weight >= (1 if from_behind and not motion.has_cue("slowing", 3) else 3)
    ]
    if motion.has_cue("code:stopped"):
        return from_behind or bool(stops) or not motion.has_cue("moved_on", 3)
    if not stops:
        return False
    return from_behind or not _moved_on(motion, stops[0])


def meant_turn(motion: VehicleMotion, maneuver: Maneuver | None = None) -> Decision | None:
    """The turn that a vehicle waited, slowed or wanted to make; of one that did no more than stop or slow (`maneuver`)
    also one that is told behind that ("stopped to turn left")."""
    wants = [d for d in motion.cues if d.kind.startswith("want_turn_")]
    if not wants and maneuver in ("stopped", "slowing"):
        since = min((d.when for d in motion.cues if d.kind == maneuver), default=None)
        wants = [d for d in motion.cues if d.kind in _TURNS and since is not None and d.when > since]
    return _as_told(max(wants, key=lambda d: d.weight)) if wants else None


def _over_the_line(motion: VehicleMotion, cue: ManeuverCue) -> Decision:
    """Over a lane line: beside a vehicle that drives the same way it is a change of lane."""
    left = cue.kind == "code:over_left"
    if any(relation == "same" and word == "code" for _, relation, _, word in motion.relations):
        return Decision("lane_change_left" if left else "lane_change_right", cue=cue)
    return Decision("crossing_centerline" if left else "departing_road_right", cue=cue)


def _before_the_rest(motion: VehicleMotion, acts: list[ManeuverCue]) -> ManeuverCue | None:
    """Passing that is told before the way over the middle of the road that it took; a merge of one from a ramp."""
    passing, over = motion.cue("overtaking", 3), next((d for d in acts if d.kind == "crossing_centerline"), None)
    if passing and over and passing.when < over.when:
        return passing
    return motion.cue("merge", 3) if motion.origin == RAMP else None


def _moving(motion: VehicleMotion, least: int) -> Decision:
    acts = _within_road(motion.cues)
    if first := _before_the_rest(motion, acts):
        return Decision(first.kind, cue=first)  # type: ignore[arg-type]
    acts = _without_returns(acts)
    for kind in _PLAIN:
        if cue := next((d for d in acts if d.kind == kind and d.weight >= 3), None):
            return Decision(kind, cue=cue)
    for over in ("code:over_left", "code:over_right"):
        if (cue := motion.cue(over)) and not motion.has_cue("code:straight"):
            return _over_the_line(motion, cue)
    for out, change in _OUT_OF_LANE.items():
        if cue := motion.cue(out, 3):
            return Decision(change, cue=cue)
    if cue := motion.cue("lane_change", 3):
        return Decision("lane_change_left", False, cue)
    if cue := motion.cue("negotiating_curve", 3):
        return Decision("negotiating_curve", cue=cue)
    for side in DEPARTURES:
        if cue := motion.cue(f"code:{side}"):
            return Decision(side, cue=cue)
    if cue := motion.cue("slowing", least) or motion.cue("code:slowing"):
        return Decision("slowing", cue=cue)
    cue = motion.cue("straight") or motion.cue("code:straight")
    return Decision("straight", cue is not None, cue)
