"""Near crashes: the stated evasion, as late and as strong as leaves the declared clearance.

The encounter that would be a contact is given; its motions are changed from some time before it, all evasions by one
share of the most that a driver does. The share is solved by bisection so that the least distance of the boxes is the
declared one. Without an evasion one of the two comes earlier or later instead. Knows only this pair.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.distances import box_distances
from sgcad_core.planner.encounter.conflict import Conflicts
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.motion import LEAD_S, STEP_S, Motion, clock
from sgcad_core.planner.near_crash.evasion import (
    CROSSES,
    MOST_STEER_M,
    SLIGHT_STEER_M,
    Reaction,
    reacted,
    returns_m,
    told_of,
)
from sgcad_core.planner.near_crash.near_thing import is_beside_lanes, near_thing
from sgcad_core.records.specs import Evasion, EvasiveManeuver, NearCrash

ONSETS_S = (0.8, 1.1, 1.4, 1.7, 2.0, 2.4, 2.8, 3.3, 3.9, 4.6, 5.4)
"""Times before the contact at which an evasion may begin; the latest sufficient one is taken."""
_HARD = 1.4
"""Factor on usual braking where that is not enough: emergency braking, 7 m/s2 on dry roads."""
_GENTLE = 0.5
"""Share of usual braking when slowing for traffic: 2.5 m/s2 on dry roads."""
_HALVINGS = 22
_EXACT_M = 0.02
_SHIFT_S, _MOST_SHIFT_S = 0.1, 4.0
_ALONG_RAD = 0.6
_KEEPS = 0.85
"""Speed after braking behind a moving vehicle, over that of the vehicle."""
_AFTER_S = 5.0
_TO_EDGE_M = 0.3
"""From the middle of a box to the edge of its lanes at least."""
_BRAKING_TOO: dict[EvasiveManeuver, EvasiveManeuver] = {
    "steering": "braking_and_steering", "steering_left": "braking_and_steering_left",
    "steering_right": "braking_and_steering_right",
}  # fmt: skip


class NearMiss(NamedTuple):
    """The encounter with the motions that avoid it (None where nothing does), and notes on what was done."""

    encounter: Encounter | None
    notes: tuple[str, ...]


class _Side(NamedTuple):
    """One of the two: its option, the motion in the conflict, and its own time at the avoided contact."""

    option: Option
    motion: Motion
    own_s: float

    @property
    def id(self) -> str:
        return self.option.role.actor.id

    @property
    def may_evade(self) -> bool:
        return not self.motion.standing and not self.option.role.actor.record.thing

    def within_lanes(self, reaction: Reaction) -> Reaction:
        """A reaction with no more steering than keeps it in the lanes of its direction."""
        course = self.option.role.course
        low, high = -course.right_edge_m + _TO_EDGE_M, course.own_left_m - _TO_EDGE_M
        return reaction._replace(left_m=min(max(reaction.left_m, min(low, 0.0)), max(high, 0.0)))

    def velocity(self, after_s: float = 0.0) -> tuple[float, float]:
        """Velocity at a time after the contact, m/s."""
        if self.motion.standing:
            return 0.0, 0.0
        at_s = self.own_s + after_s
        before, at = self.motion.poses([at_s - STEP_S, at_s])
        return float(at[0] - before[0]) / STEP_S, float(at[1] - before[1]) / STEP_S


def near_encounter(conflicts: Conflicts, near: NearCrash) -> NearMiss:
    """The encounter of a near crash: beside a thing off the lanes, else an ordinary conflict and its evasion."""
    pair = conflicts.roles(near.conflict)
    if is_beside_lanes(*pair):
        return NearMiss(*near_thing(*pair, near))
    made = as_near_miss(conflicts.as_they_drive(near.conflict), near)
    started = [who for who, told in conflicts.told.items() if told.from_rest]
    if made.encounter is not None or not started:
        return made
    rolling = {who: replace(told, from_rest=False) for who, told in conflicts.told.items()}
    made = as_near_miss(replace(conflicts, told=rolling).as_they_drive(near.conflict), near)
    return made._replace(notes=(*(f"{who} is not seen starting from rest" for who in started), *made.notes))


def as_near_miss(found: Encounter | None, near: NearCrash) -> NearMiss:
    """An encounter as a near crash with the declared clearance, if there is an encounter and a way to avoid it."""
    if found is None:
        return NearMiss(None, ())
    meeting = found.meeting
    found = found._replace(meeting=meeting._replace(
        first=_stopping(found.first, meeting.first, meeting.first_s),
        second=_stopping(found.second, meeting.second, meeting.second_s)))  # fmt: skip
    meeting = found.meeting
    sides = (
        _Side(found.first, meeting.first, meeting.first_s),
        _Side(found.second, meeting.second, meeting.second_s),
    )
    none = NearMiss(None, (f"no evasion keeps {near.conflict.striker} and {near.conflict.struck} apart",))
    return _Parting(found, sides, near.closest_m).best(near) or none


def _stopping(option: Option, motion: Motion, own_s: float) -> Motion:
    """A `slowing` actor brakes on to a stop after the conflict, gently."""
    if option.role.actor.maneuver != "slowing" or motion.standing:
        return motion
    return reacted(option, motion, Reaction(own_s - STEP_S, braking=_GENTLE))


@dataclass(frozen=True)
class _Parting:
    """The search for one pair."""

    found: Encounter
    sides: tuple[_Side, _Side]
    closest_m: float

    def best(self, near: NearCrash) -> NearMiss | None:
        """As stated; else by other means, with a note."""
        told = [e for e in near.evasions if e.maneuver != "none"]
        follows = near.conflict.striker_area == "front" and near.conflict.struck_area == "back"
        back = any(side.id == e.actor and returns_m(side.option, e.maneuver) for side in self.sides for e in told)
        parted = ((None if back else self._evaded(told, told=False)) or self._evaded(told)) if told else None
        as_told = parted if told else None if follows else self._shifted()
        if as_told is not None:
            return as_told
        for side in () if told else self.sides:
            if side.option.role.actor.maneuver == CROSSES and (made := self._returned([(side, "steering_right")])):
                return made._replace(notes=(f"{side.id} steers back, though nobody says so", *made.notes))
        for evasion in self._instead(near):
            if parted := self._evaded([evasion], told=False):
                words = "evades otherwise than told" if told else "evades, though nobody says so"
                return parted._replace(notes=(f"{evasion.actor} {words}", *parted.notes))
        return self._shifted() if told or follows else None

    def _instead(self, near: NearCrash) -> Iterator[Evasion]:
        """Other evasions: of the actor with a stated one, then of the striker, then of the struck one."""
        maneuvers: tuple[EvasiveManeuver, ...] = ("braking", "braking_and_steering", "steering")
        for told in near.evasions:
            if told.maneuver.startswith("steering"):
                yield Evasion(actor=told.actor, maneuver=_BRAKING_TOO[told.maneuver])
        names = [e.actor for e in near.evasions] + [near.conflict.striker, near.conflict.struck]
        for name, maneuver in product(dict.fromkeys(names), maneuvers):
            yield Evasion(actor=name, maneuver=maneuver)

    # -------------------------------------------------------------- evasions
    def _evaded(self, evasions: list[Evasion], *, told: bool = True) -> NearMiss | None:
        """The latest start and the least share that leave the clearance; usual braking before emergency braking.

        Steering stays within the lanes unless it is `told`.
        """
        acting = [(side, e.maneuver) for e in evasions for side in self.sides if side.id == e.actor and side.may_evade]
        if not acting:
            return None
        if told and (made := self._returned(acting)):
            return made
        sides = (1.0, -1.0) if any(m.endswith("steering") for _, m in acting) else (1.0,)
        for hard, onset, left in product((1.0, _HARD), ONSETS_S, sides):
            most = {s.id: self._most(s, m, onset, left)._replace(hard=hard) for s, m in acting}
            most = most if told else {s.id: s.within_lanes(most[s.id]) for s, _ in acting}
            if (share := self._share(most)) is not None:
                return self._told(acting, most, share, onset)
        return None

    def _returned(self, acting: list[tuple[_Side, EvasiveManeuver]]) -> NearMiss | None:
        """Back into the lane from which one began to change, the latest so that the declared clearance is left."""
        if not any(returns_m(side.option, how) for side, how in acting):
            return None

        def most(onset_s: float) -> dict[str, Reaction]:
            found = {side.id: self._most(side, how, onset_s, 1.0) for side, how in acting}
            back = {side.id: by for side, how in acting if (by := returns_m(side.option, how))}
            return {who: r._replace(left_m=back[who], stays=True) if who in back else r for who, r in found.items()}

        def clear(onset_s: float) -> bool:
            motions = self._motions(most(onset_s), 1.0)
            return all(m.drivable for m in motions) and self._least(motions) >= self.closest_m

        onset = next((s for s in ONSETS_S if clear(s)), None)
        if onset is None:
            return None
        onset = _least_enough(clear, onset, _HALVINGS)
        done = most(onset)
        return None if self._too_far(self._motions(done, 1.0)) else self._told(acting, done, 1.0, onset)

    def _most(self, side: _Side, maneuver: EvasiveManeuver, onset_s: float, left: float) -> Reaction:
        """The strongest reaction of a maneuver that begins `onset_s` before the contact; `left`: the side where it is
        open."""
        if maneuver.endswith(("left", "right")):
            left = 1.0 if maneuver.endswith("left") else -1.0
        brakes, steers = maneuver.startswith("braking"), "steering" in maneuver
        aside = (SLIGHT_STEER_M if brakes else MOST_STEER_M) * left if steers else 0.0
        down_to = self._down_to(side) if brakes else 0.0
        speeds_up = float(maneuver == "accelerating")
        return Reaction(side.own_s - onset_s, float(brakes), speeds_up, aside, down_to)

    def _down_to(self, side: _Side) -> float:
        """The speed at which a follower need not brake further; 0 where the other one crosses or stands."""
        other = self.sides[1] if side is self.sides[0] else self.sides[0]
        (ax, ay), (bx, by) = side.velocity(), other.velocity()
        if abs(math.remainder(math.atan2(ay, ax) - math.atan2(by, bx), 2 * math.pi)) > _ALONG_RAD:
            return 0.0
        slowest = min(math.hypot(bx, by), math.hypot(*other.velocity(_AFTER_S)))
        return _KEEPS * slowest if slowest < math.hypot(ax, ay) else 0.0

    def _share(self, most: dict[str, Reaction]) -> float | None:
        """The share of the reactions at which the boxes come as near as declared; None where there is none."""

        def clear(share: float) -> bool:
            motions = self._motions(most, share)
            return all(m.drivable for m in motions) and self._least(motions) >= self.closest_m

        share = _least_enough(clear, 1.0, _HALVINGS) if clear(1.0) else None
        if share is None or self._too_far(self._motions(most, share)):
            return None  # too little, or a swerve that only as a whole passes on the other side
        return share

    def _too_far(self, motions: tuple[Motion, Motion], shift_s: float = 0.0) -> bool:
        """Whether the two never come as near as declared in the shortest scenario there may be."""
        return self._least(motions, shift_s, LEAD_S[0]) > self.closest_m + _EXACT_M

    def _motions(self, most: dict[str, Reaction], share: float) -> tuple[Motion, Motion]:
        first, second = (
            reacted(s.option, s.motion, most[s.id].scaled(share)) if s.id in most else s.motion for s in self.sides
        )
        return first, second

    def _least(self, motions: tuple[Motion, Motion], shift_s: float = 0.0, lead_s: float = LEAD_S[1]) -> float:
        """The least distance of the boxes in a scenario with that lead, metres; the first is `shift_s` later."""
        times = clock(-round(lead_s / STEP_S), round(_AFTER_S / STEP_S) + 1)
        first, second = (
            np.repeat(m.poses([s.own_s]), len(times), axis=0) if m.standing else m.poses(s.own_s + times - by)
            for m, s, by in zip(motions, self.sides, (shift_s, 0.0), strict=True)
        )
        return float(box_distances(first, motions[0].size, second, motions[1].size).min())

    def _told(
        self, acting: list[tuple[_Side, EvasiveManeuver]], most: dict[str, Reaction], share: float, onset_s: float
    ) -> NearMiss:
        motions = self._motions(most, share)
        notes = tuple(told_of(s.option.role, how, most[s.id].scaled(share), onset_s) for s, how in acting)
        return NearMiss(self._replaced(motions), notes)

    def _replaced(self, motions: tuple[Motion, Motion], shift_s: float = 0.0) -> Encounter:
        meeting = self.found.meeting
        return self.found._replace(meeting=meeting._replace(
            first=motions[0], second=motions[1], first_s=meeting.first_s - shift_s))  # fmt: skip

    # -------------------------------------------------------------- without an evasion
    def _shifted(self) -> NearMiss | None:
        """One of the two slightly earlier or later, where that alone leaves the clearance."""
        motions = self.sides[0].motion, self.sides[1].motion
        if motions[0].standing or motions[1].standing:
            return None
        found = [by for sign in (1.0, -1.0) if (by := self._shift(motions, sign)) is not None]
        if not found:
            return None
        by = min(found, key=abs)
        late = self.sides[0].id if by > 0 else self.sides[1].id
        words = f"nobody evades: {late} comes {abs(by):.1f} s too late to touch"
        return NearMiss(self._replaced(motions, by), (words,))

    def _shift(self, motions: tuple[Motion, Motion], sign: float) -> float | None:
        steps = np.arange(1, round(_MOST_SHIFT_S / _SHIFT_S) + 1) * _SHIFT_S
        enough = next((float(s) for s in steps if self._least(motions, sign * s) >= self.closest_m), None)
        if enough is None:
            return None
        by = sign * _least_enough(lambda by: self._least(motions, sign * by) >= self.closest_m, enough, _HALVINGS)
        return None if self._too_far(motions, by) else by


def _least_enough(enough: Callable[[float], bool], most: float, halvings: int) -> float:
    """The least number up to `most` (which is enough) that is enough, by halving from 0."""
    low, high = 0.0, most
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high
