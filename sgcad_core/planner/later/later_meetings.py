"""The contacts of vehicles after the first one, arranged in told order.

Each is searched on what came about before it: a vehicle that is not in the scene yet drives or stands where its partner
then comes by; two that are both there run out towards each other; two that are both absent meet on their own courses.
Knows scenes, roles and encounters; no report.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from sgcad_core.planner.actor_plan import Role, Twist, is_standing
from sgcad_core.planner.aftermath.ground_friction import RunOut
from sgcad_core.planner.aftermath.second_contact import sides_missed
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.aftermath.told_order import ToldOrder, other_of, pair_of
from sgcad_core.planner.encounter.encounter_search import Meeting, find_meeting
from sgcad_core.planner.encounter.maneuver_choices import lines_to
from sgcad_core.planner.encounter.meeting_place import place_near
from sgcad_core.planner.encounter.motion_options import Option, forced, options
from sgcad_core.planner.encounter.pacing_choices import pacings
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.later.later_courses import runs_aside, runs_into, runs_to_line, with_run
from sgcad_core.planner.later.later_places import ToBeStruck, lane_line, not_as_told
from sgcad_core.planner.motion import STEP_S, Motion
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.specs import Area, Contact
from sgcad_core.roads.surface import RoadSurface

_SPANS_S = ((0.7, 3.5), (0.1, 0.7), (3.5, 4.4))
"""Time spans after the last contact in which the next one is searched: a pair has parted by then."""
_SOON_S = ((0.4, 1.5), (1.5, 3.5), (0.1, 0.4), (3.5, 4.4))
"""The same where further contacts follow."""
_TARGETS_S = (1.2, 0.5, 2.5, 4.4)
"""Times after the last contact at which the partner's place is aimed at."""
_WAYS, _AIMED_WAYS = 6, 3
_TRIES, _RUNS = 8, 6
"""Scenes that are settled for one contact at most."""
_STEERS, _STEERED_TRIES, _STEER_COSTS = 6, 2, 3
"""Ways in which a partner steers so that the stated sides meet, the scenes that are settled for each, and what a way
costs beside."""
_BODIES = 60
"""Bodies that are settled again in a whole scene so that further contacts come about on the stated sides; scenes of
many take long."""
_ACROSS, _ALONG_RAD = 2, math.radians(50.0)
"""Weight of a vehicle that stands across its road, at more than this angle: as much as both sides of a contact."""
_ASTRAY = 2
"""Weight of a vehicle that is struck beside its lane, untold, or at another speed than told."""
_UNTOLD = 3
"""Weight of an untold contact: more than of both sides of a told one."""
_OUTSIDE, _STARTS_M = 20.0, 4.0
_GRAZE_M, _FAR_M = 0.4, 14.0
"""Overlap of a graze, and how far aside of its line a vehicle is led into a contact."""
_DELAYS_S = (0.8, 1.6, 2.6, 0.3, 3.6)
"""Times after the last contact at which two others meet."""
_BACK_M = (0.0, 15.0, 30.0, 50.0, 80.0)
"""How far before their usual place two others meet, so that they keep clear of those before."""

Sides = tuple[Area, Area]


@dataclass
class LaterMeetings:
    """Arranges contacts of vehicles on a scene that holds the first one."""

    scene: Scene
    surface: RoadSurface
    role_of: Callable[[str], Role]
    encounter_of: Callable[[Contact], Encounter | None]
    order: ToldOrder
    left: int = _BODIES
    """Bodies that may still be settled for the stated sides of contacts that come about on others."""

    def arrange(self, contact: Contact, *, more: bool) -> bool:
        """Brings a contact about behind those before it; False where that is not possible. `more`: others follow."""
        pair, tracks = pair_of(contact), self.scene.tracks
        placed = [name for name in (contact.striker, contact.struck) if name in tracks]
        if len(placed) == 2:
            done = self.order.holds(pair) or self._run_together(contact)
        elif placed:
            done = self._with_partner(contact, placed[0], more=more)
        else:
            done = self._both(contact)
        if done:
            self.order.pairs.append(pair)
            self.order.arranged.append(contact)
        return done

    # -------------------------------------------------------------- trials
    def _best_of(self, contact: Contact, trials: Iterator[tuple[Track, ...]]) -> float:
        """Places the tracks with which the contact comes next in order, the fewest untold ones come about, and it is
        on the stated sides; what it misses, infinite where none brings it about."""
        best: tuple[int, tuple[Track, ...]] | None = None
        for tracks in islice(trials, _TRIES):
            if best and best[0] < _UNTOLD and not self._goes_on():
                break
            self._place(tracks)
            missed = _UNTOLD * self.order.untold + sides_missed(self.scene, contact)
            missed += _ACROSS * sum(map(self._stands_across, tracks))
            missed += _ASTRAY * sum(not_as_told(self.role_of(one.actor), one, self.surface) for one in tracks)
            if self.order.holds(pair_of(contact)) and (best is None or missed < best[0]):
                best = missed, tracks
            for track in tracks:
                del self.scene.tracks[track.actor]
            self.scene.settle()
            if best and best[0] == 0:
                break
        self._place(best[1] if best else ())
        return best[0] if best else math.inf

    def _stands_across(self, track: Track) -> bool:
        """Whether a vehicle stands across its road, where it is neither parked nor waits."""
        if not track.motion.standing:
            return False
        course = self.role_of(track.actor).course
        along = float(course.path.poses([place_near(course, track.poses[0]).station_m])[0, 2])
        return abs(math.sin(float(track.poses[0, 2]) - along)) > math.sin(_ALONG_RAD)

    def _goes_on(self, settles: int = 1) -> bool:
        """Whether another try of so many settled scenes may be made for stated sides alone; counts it."""
        self.left -= settles * len(self.scene.tracks)
        return self.left >= 0

    def _place(self, tracks: tuple[Track, ...]) -> None:
        self.scene.tracks.update({track.actor: track for track in tracks})
        self.scene.settle()

    # -------------------------------------------------------------- one is there
    def _with_partner(self, contact: Contact, partner: str, *, more: bool) -> bool:
        """Lets a new actor meet one that is there, which steers otherwise where the stated sides do not meet so."""
        scene, (new, sides) = self.scene, other_of(contact, partner)
        role = self.role_of(new)
        least = self._best_of(contact, ((track,) for track in self._tracks(role, partner, sides, more=more)))
        best, place = scene.runs, scene.tracks.pop(new, None)
        steers = self._steers(role, partner, sides, least)
        for run in islice(steers, _STEERS):
            if not self._goes_on(_STEER_COSTS):
                break
            scene.runs = with_run(scene, partner, run)
            scene.settle()
            tracks = self._tracks(role, partner, sides, more=more, wants=(sides,)) if self.order.kept else ()
            missed = self._best_of(contact, islice(((track,) for track in tracks), _STEERED_TRIES))
            track = scene.tracks.pop(new, None)
            if missed < least:
                least, best, place = missed, scene.runs, track
            scene.runs = best
            if not least:
                break
        scene.runs = best
        self._place((place,) if place else ())
        return place is not None

    def _steers(self, role: Role, partner: str, sides: Sides, missed: float) -> Iterator[RunOut]:
        """Ways of a partner to steer: into the lane of a new actor that else is met beside it, then to other sides; not
        where two meet along one line."""
        if missed >= _ASTRAY:
            yield from islice(runs_to_line(self.scene, partner, lane_line(role), self.order.after), _STEERS - 1)
        if missed > 0 and set(sides) != {"front", "back"}:
            yield from runs_aside(self.scene, partner, self.order.after)

    def _tracks(
        self, role: Role, partner: str, sides: Sides, *, more: bool, wants: Sequence[Sides | None] | None = None
    ) -> Iterator[Track]:
        """Tracks of a new actor that its partner comes across, the most ordinary first; `wants`: the sides to meet on,
        else the stated ones and then any."""
        after = self.order.after
        if is_standing(role):
            place = ToBeStruck(self.scene, role, partner, sides, self.surface, more)
            yield from (standing_track(self.scene, role.actor, pose) for pose in islice(place.poses(after), _TRIES))
        ways: list[list[Option]] = []
        for want in (sides, None) if wants is None else wants:
            for number, target_s in enumerate(_TARGETS_S if wants is None else _TARGETS_S[:1]):
                if number == len(ways):
                    ways.append(self._ways(role, partner, sides, after + round(target_s / STEP_S), plain=not number))
                for span in _SOON_S if more else _SPANS_S:
                    yield from self._meetings(ways[number], self.scene.replay(partner, after, *span), after, want)

    def _ways(self, role: Role, partner: str, sides: Sides, sample: int, *, plain: bool) -> list[Option]:
        """Options of driving to the place of a partner at a sample, past both its sides; `plain`: ordinary ones too."""
        track, k = self.scene.tracks[partner], min(sample, self.scene.count - 1)
        mps = math.dist(track.poses[k, :2], track.poses[k - 1, :2]) / STEP_S
        near = replace(role, place=place_near(role.course, track.poses[k]), side=sides[1], other_side=sides[0],
                       other_mps=mps, other_width_m=track.size[1])  # fmt: skip
        if role.actor.record.laneless or is_standing(role):
            return options(near)[:_WAYS] + forced(near)[:_WAYS] if plain else forced(near)[:_AIMED_WAYS]
        lines = lines_to(near, _lefts(near, track.size))
        aimed = [Option(near, line, pacing, Twist(0.0)) for pacing in pacings(near)[:2] for line in lines]
        return options(near)[:_WAYS] + aimed + forced(near)[:_AIMED_WAYS] if plain else aimed

    def _meetings(self, ways: list[Option], replay: Motion, after: int, want: Sides | None) -> Iterator[Track]:
        for way in ways:
            found = self._meeting(replay, way.motion, want)
            if found and (track := self._until(way.role, found, after)):
                yield track

    def _meeting(self, replay: Motion, motion: Motion, want: Sides | None) -> Meeting | None:
        if not motion.drivable:
            return None
        found = find_meeting(replay, replace(motion, penalty=0 * motion.penalty), want)
        return found if found is not None and found.cost <= _OUTSIDE else None

    def _until(self, role: Role, found: Meeting, after: int) -> Track | None:
        """The track to a meeting with a replay; None where it touches another actor earlier."""
        scene, step = self.scene, math.ceil(found.first_s / STEP_S - 1e-6)
        late_s = found.first_s + (after - scene.contact) * STEP_S
        at_contact = found.second_s if found.second.standing else found.second_s - late_s
        track = scene.track(role.actor.id, role.actor.kind, found.second, at_contact, brakes=False)
        k = after + step
        free = after < k < scene.count - 1 and scene.clear_until(track.poses, track.size, 0.0) >= k
        return track if free and self._starts_on_road(track) else None

    def _starts_on_road(self, track: Track) -> bool:
        """Whether what drives starts on the road or right beside it: the network ends some hundred metres away."""
        return track.motion.standing or float(self.surface.off(track.poses[:1, :2])[0][0]) < _STARTS_M

    # -------------------------------------------------------------- both are there
    def _run_together(self, contact: Contact) -> bool:
        """Lets one of both run out so that it touches the other, on the stated sides if that is possible; as before
        where that does not come about."""
        scene, before = self.scene, self.scene.runs
        best, least = before, math.inf
        for name, run in self._runs_together(contact):
            if best is not before and not self._goes_on():
                break
            scene.runs = with_run(scene, name, run)
            scene.settle()
            if self.order.holds(pair_of(contact)) and (missed := sides_missed(scene, contact)) < least:
                best, least = scene.runs, missed
            scene.runs = before
            scene.settle()
            if least == 0:
                break
        scene.runs = best
        scene.settle()
        return best is not before

    def _runs_together(self, contact: Contact) -> Iterator[tuple[str, RunOut]]:
        """Run-outs of either of two that lead into the other one."""
        sides = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
        for name, other in ((contact.striker, contact.struck), (contact.struck, contact.striker)):
            runs = islice(runs_into(self.scene, name, other, self.order.after, sides[name]), _RUNS)
            yield from ((name, run) for run in runs)

    # -------------------------------------------------------------- none is there
    def _both(self, contact: Contact) -> bool:
        found = self.encounter_of(contact)
        return found is not None and self._best_of(contact, self._pairs(found)) < math.inf

    def _pairs(self, found: Encounter) -> Iterator[tuple[Track, ...]]:
        """The two on the clock of the scene, at several places and times, where no actor is in their way."""
        for back_m in _BACK_M:
            moved = _moved_back(found, back_m) if back_m else found
            for delay_s in _DELAYS_S if moved else ():
                tracks = self._at(moved, self.order.after + round(delay_s / STEP_S)) if moved else ()
                if tracks:
                    yield tracks

    def _at(self, found: Encounter, sample: int) -> tuple[Track, ...]:
        """Both tracks of an encounter that comes about at a sample; () where another actor is in the way."""
        scene, meeting = self.scene, found.meeting
        late_s = (sample - scene.contact) * STEP_S
        tracks = []
        for option, motion, own in ((found.first, meeting.first, meeting.first_s),
                                    (found.second, meeting.second, meeting.second_s)):  # fmt: skip
            actor = option.role.actor
            at_contact = own if motion.standing else own - late_s
            tracks.append(scene.track(actor.id, actor.kind, motion, at_contact, brakes=False))
        on_road = all(self._starts_on_road(track) for track in tracks)
        clear = (
            on_road
            and sample < scene.count - 1
            and all(scene.clear_until(t.poses, t.size, 0.0) >= sample for t in tracks)
        )
        return tuple(tracks) if clear else ()


def _lefts(role: Role, size: tuple[float, float]) -> list[float]:
    """How far beside its line an actor meets the middle and grazes either side of a partner at its meeting place."""
    angle, aside = role.place.angle_rad, role.place.aside_m
    half = (size[0] * abs(math.sin(angle)) + size[1] * abs(math.cos(angle)) + role.size[1]) / 2 - _GRAZE_M
    return [left for left in (aside, aside - half, aside + half) if abs(left) < _FAR_M]


def _moved_back(found: Encounter, by_m: float) -> Encounter | None:
    """An encounter on the same sides further back on the way of the first one; None where there is none."""
    first, second = found.first, found.second
    here = first.role.place._replace(station_m=first.role.place.station_m - by_m)
    pose = first.role.course.path.poses([here.station_m])[0]
    one = replace(first, role=replace(first.role, place=here))
    two = replace(second, role=replace(second.role, place=place_near(second.role.course, pose)))
    motions = one.motion_with(two), two.motion_with(one)
    if not all(motion.drivable for motion in motions):
        return None
    meeting = find_meeting(*motions, found.meeting.sides)
    return Encounter(one, two, meeting) if meeting else None
