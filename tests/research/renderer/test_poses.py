"""Who stands where in drawings: on their ways at the impact, in order before it, and seen."""

import math
from itertools import pairwise
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Actor, Contact, Crash, Leg
from research.renderer import around
from research.renderer.boxes import overlap, wrap
from research.renderer.lines import Ground, headings
from research.renderer.pen import Pen
from research.renderer.poses import Stage, Track
from research.renderer.road_marks import RoadMarks

seeds = st.integers(0, 10**6)
CLEAR = ("day", "clear", "dry")


def _stage(seed: int) -> tuple[Crash, Stage, list[Track]]:
    crash = sample_crash(Random(seed))
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0, centered=bool(seed % 2))
    stage = Stage(Random(seed), crash, ground, 1.2)
    return crash, stage, stage.tracks()


def test_those_who_turn_are_hit_where_they_drive_and_as_they_are_turned() -> None:
    aside, askew = [], []
    for seed in range(400):
        crash, stage, _ = _stage(seed)
        for index, at in stage.at.items():
            if crash.actors[index].maneuver in ("turn_left", "turn_right") and len(crash.contacts) == 1:
                gaps = np.hypot(*(stage.ways[index] - (at.x, at.y)).T)
                aside.append(gaps.min())
                askew.append(abs(wrap(at.heading - headings(stage.ways[index])[gaps.argmin()])))
    assert len(aside) > 80
    assert np.mean(np.array(aside) > 2.5) < 0.2
    assert np.mean(np.array(askew) > math.radians(50)) < 0.08


@pytest.mark.parametrize("config", ["u_turn", "rear_end"])
def test_two_of_one_road_meet_where_they_part_and_are_seen_to_come(config: str) -> None:
    came, far = [], []
    for seed in range(400):
        crash = sample_crash(Random(seed), config)
        first, second = (crash.actors[i] for i in (crash.contacts[0].striker, crash.contacts[0].struck))
        turns = {first.maneuver, second.maneuver} & {"u_turn", "turn_left", "turn_right"}
        if first.leg != second.leg or not turns:
            continue
        ground = Ground(crash, {leg.bearing: 60.0 for leg in crash.legs}, 100.0)
        for track in Stage(Random(seed), crash, ground, 1.0).tracks():
            came.append(track.contact > 0 or track.actor.maneuver in ("stopped", "parked"))
            far.append(math.hypot(track.poses[track.contact].x, track.poses[track.contact].y))
    assert len(came) > 10
    assert np.mean(came) > 0.9
    assert np.mean(np.array(far) > 40) < 0.1


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_those_who_do_not_touch_do_not_lie_on_each_other_at_the_impact(seed: int) -> None:
    crash = sample_crash(Random(seed), "head_on")
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0)
    tracks = Stage(Random(seed), crash, ground, 1.0).tracks()
    if len(tracks) == 3:
        apart = ({0, 1, 2} - {crash.contacts[1].striker, crash.contacts[1].struck}, crash.contacts[1].striker)
        one, two = tracks[apart[0].pop()], tracks[apart[1]]
        assert not overlap(one.poses[one.contact], (3.6, 1.4), two.poses[two.contact], (3.6, 1.4))


@pytest.mark.parametrize("seed", range(12))
def test_nobody_on_foot_pushes_a_car_off_its_course(seed: int) -> None:
    crash = sample_crash(Random(seed), "pedestrian")
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0)
    car = next(t for t in Stage(Random(seed), crash, ground, 1.0, rests=1.0).tracks() if t.actor.vehicle)
    at = car.poses[car.contact]
    for rest in car.poses[car.contact + 1 :]:
        assert abs(wrap(math.atan2(rest.y - at.y, rest.x - at.x) - at.heading)) < math.radians(40)


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_no_place_that_one_came_from_lies_on_anothers(seed: int) -> None:
    tracks = [track for track in _stage(seed)[2] if track.actor.vehicle and track.actor.kind != "bicycle"]
    for track in tracks:
        for other in tracks:
            before, came = track.poses[: track.contact], other.poses[: other.contact + 1]
            for k, pose in enumerate(before):
                later = came if other is not track else came[k + 2 :]
                assert not any(overlap(pose, track.size, one, other.size) for one in later)


@settings(max_examples=40, deadline=None)
@given(seed=seeds, first=st.sampled_from(("car", "truck")), vehicles=st.integers(2, 3))
def test_in_a_queue_who_is_hit_from_behind_came_ahead(seed: int, first: str, vehicles: int) -> None:
    legs = [Leg(0, 1, 1), Leg(4, 1, 1)]
    actors = [Actor(f"V{k + 1}", first if not k else "car", 0, 4, "straight", 1) for k in range(vehicles)]
    contacts = [Contact(k, k + 1, "front", "back") for k in range(vehicles - 1)]
    crash = Crash("rear_end", "plain", 0, legs, actors, contacts, *CLEAR)
    tracks = Stage(Random(seed), crash, Ground(crash, {0: 120.0, 4: 60.0}, 100.0), 1.2).tracks()
    assert [track.actor.id for track in tracks] == [actor.id for actor in actors]
    assert all(track.contact for track in tracks)
    for behind, ahead in pairwise(tracks):
        assert behind.poses[0].y > ahead.poses[0].y + (behind.size[0] + ahead.size[0]) / 2


@pytest.mark.parametrize("uses", [["through_right", "left"], ["through", "through", "left"]])
def test_who_drives_straight_on_past_facing_turn_lanes_does_not_swerve(uses: list[str]) -> None:
    legs = [Leg(b, len(uses), len(uses) - 1, turns_in=list(uses)) for b in (0, 4)] + [Leg(b, 1, 1) for b in (2, 6)]
    driver = Actor("V1", "car", 0, 4, "straight", 1)
    crash = Crash("crossing", "four", 0, legs, [driver], [], *CLEAR)
    lengths = {leg.bearing: 50.0 for leg in legs}
    swerves = {c: np.ptp(Ground(crash, lengths, 100.0, centered=c).way(driver)[:, 0]) for c in (True, False)}
    assert swerves[True] < 0.01
    assert swerves[False] > 3


def test_a_leg_begins_where_the_curb_of_the_road_that_it_meets_lies_on_its_side() -> None:
    legs = [Leg(0, 1, 1), Leg(2, 3, 0), Leg(4, 1, 1), Leg(6, 0, 3)]
    ground = Ground(Crash("crossing", "four", 0, legs, [], [], *CLEAR), {leg.bearing: 50.0 for leg in legs}, 100.0)
    assert ground.setback(0, 0.0) == pytest.approx(3 * 3.6)
    assert ground.setback(4, 0.0) == pytest.approx(0.0)


def test_a_turn_that_is_not_begun_at_the_impact_is_drawn_ahead() -> None:
    found = 0
    for seed in range(300):
        for track in _stage(seed)[2]:
            turn = {"turn_left": 1, "turn_right": -1}.get(track.actor.maneuver)
            if track.ahead is None or turn is None:
                continue
            found += 1
            gone = wrap(float(headings(track.ahead)[-1]) - track.poses[track.contact].heading)
            assert turn * gone > math.radians(40)
    assert found > 5


@pytest.mark.parametrize("leg", [0, 2, 4, 6])
def test_the_way_ahead_turns_as_far_whatever_the_compass(leg: int) -> None:
    legs = [Leg(b, 1, 1) for b in (0, 2, 4, 6)]
    actors = [Actor("V1", "car", leg, (leg + 2) % 8, "turn_left", 1), Actor("V2", "car", leg, None, "stopped", 1)]
    crash = Crash("rear_end", "four", leg, legs, actors, [Contact(0, 1, "front", "back")], *CLEAR)
    ground = Ground(crash, dict.fromkeys((0, 2, 4, 6), 50.0), 100.0)
    (turner, _) = Stage(Random(1), crash, ground, 1.0).tracks()
    assert turner.ahead is not None
    away = headings(turner.ahead)
    assert wrap(float(away[-1] - headings(ground.way(actors[0]))[2])) == pytest.approx(math.pi / 2, abs=0.4)


def test_turn_arrows_stand_where_no_vehicle_hides_them() -> None:
    hidden: dict[bool, list[bool]] = {True: [], False: []}
    for seed, careful in ((seed, careful) for seed in range(200) for careful in hidden):
        crash, stage, tracks = _stage(seed)
        pen = Pen(Random(seed), 500, 500, 4.0, 0.0, (0.0, 0.0))
        taken = [(pose, track.size) for track in tracks for pose in track.poses]
        marks, arrows = RoadMarks(Random(seed), pen, crash, stage.ground, taken if careful else ()), []
        marks._painted = arrows.append  # type: ignore[method-assign]
        for band in stage.ground.bands.values():
            marks._arrows(band, stage.ground.setback(band.leg.bearing, 3.0))
        world = [(points[0] - 250) / 4.0 * (1, -1) for points in arrows]
        hidden[careful] += [any(_within(point, pose, size) for pose, size in taken) for point in world]
    assert len(hidden[True]) > 200
    assert np.mean(hidden[True]) < 0.5 * np.mean(hidden[False])


def _within(point: np.ndarray, pose: object, size: tuple[float, float]) -> bool:
    away = point - (pose.x, pose.y)  # type: ignore[attr-defined]
    c, s = math.cos(pose.heading), math.sin(pose.heading)  # type: ignore[attr-defined]
    return abs(away @ (c, s)) < size[0] / 2 and abs(away @ (-s, c)) < size[1] / 2


def test_a_north_arrow_stands_on_nothing_where_there_is_room() -> None:
    harmed = 0
    for seed in range(200):
        pen = Pen(Random(seed), 480, 400, 4.0, 0.4, (0.0, 0.0))
        pen.draw.rectangle((140, 100, 339, 299), fill=(0, 0, 0))
        before = np.asarray(pen.image)[100:300, 140:340].copy()
        around.north_arrow(Random(seed), pen)
        harmed += (np.asarray(pen.image)[100:300, 140:340] != before).any()
    assert harmed < 4


def test_captions_name_no_vehicle_that_is_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    pen = Pen(Random(0), 400, 400, 4.0, 0.0, (0.0, 0.0))
    written: list[str] = []
    monkeypatch.setattr(pen, "text", lambda _x, _y, text, *_: written.append(text))
    for seed in range(200):
        around.captions(Random(seed), pen, 1)
    assert any("V1" in text for text in written)
    assert not any("V2" in text for text in written)
