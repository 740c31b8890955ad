"""What holds of every plan, whatever the behavior says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import Box, box_gaps, contact_area
from sgcad_core.kinds import learned_actors
from sgcad_core.metrics.drivability import deepest_overlap, driving_peaks, first_touches
from sgcad_core.planner import Plan, plan
from sgcad_core.planner.aftermath.crush import DEEPEST_M, NARROW_M
from sgcad_core.planner.lines.box_angles import SLIDES
from sgcad_core.planner.motion import LEAD_S
from sgcad_core.planner.scene import AFTER_S
from sgcad_core.records.specs import ActorKind, Area, BehaviorSpec, Maneuver, size_m
from sgcad_core.roads.lane_graph import road_of
from tests.effort import many, spread
from tests.sgcad_core.planner.crash_scenes import LAYOUTS, draw_scene, network

STEP_S = 0.05
EXAMPLES = many(20, 200)
LONGEST_S = LEAD_S[1] + AFTER_S + 3.0
"""A lead, the usual time behind the contact, and more for who runs on far."""
KINDS, MANEUVERS, AREAS = learned_actors(), Maneuver.__args__, Area.__args__


@st.composite
def behaviors(draw) -> tuple[str, BehaviorSpec]:
    """Any behavior on any layout: odd sizes, impossible lanes, turns and contacts included."""
    layout = draw(st.sampled_from(sorted(LAYOUTS)))
    roads = sorted({road_of(edge)[0] for edge in network(layout).edges})
    ids = draw(
        st.lists(st.sampled_from(["V1", "V2", "V3", "P1", "B1", "T1", "O1", "V4"]), min_size=1, max_size=4, unique=True)
    )
    actors = [
        {
            "id": name, "kind": draw(st.sampled_from(KINDS)), "road": draw(st.sampled_from(roads)),
            "direction": draw(st.sampled_from(["forward", "backward"])),
            "lane": draw(st.none() | st.integers(1, 8)), "exit_road": draw(st.none() | st.sampled_from(roads)),
            "maneuver": draw(st.sampled_from(MANEUVERS)), "speed_mph": draw(st.none() | st.integers(0, 120)),
            "length_m": draw(st.none() | st.floats(0.2, 30)), "width_m": draw(st.none() | st.floats(0.2, 5)),
        }
        for name in ids
    ]  # fmt: skip
    contact = st.fixed_dictionaries({
        "striker": st.sampled_from(ids), "struck": st.sampled_from([*ids, "V9"]),
        "striker_area": st.sampled_from(AREAS), "struck_area": st.sampled_from(AREAS),
    })  # fmt: skip
    contacts = draw(st.lists(contact, max_size=3))
    return layout, BehaviorSpec.model_validate({"actors": actors, "contacts": contacts})


def check(behavior: BehaviorSpec, made: Plan) -> None:
    """Everything that is promised of a plan's trajectories."""
    assert [t.actor for t in made.trajectories] == [a.id for a in behavior.actors]
    clock = made.trajectories[0].t_s
    assert np.allclose(clock, np.arange(len(clock)) * STEP_S)
    assert 8.0 <= clock[-1] <= LONGEST_S
    for track in made.trajectories:
        columns = (track.x_m, track.y_m, track.heading_rad, track.speed_mps)
        assert all(len(c) == len(clock) and np.isfinite(c).all() for c in columns)
        assert np.array_equal(track.t_s, clock)
        step = np.hypot(np.diff(track.x_m), np.diff(track.y_m))
        fastest = np.maximum(track.speed_mps[1:], track.speed_mps[:-1])
        assert (step <= 1.5 * STEP_S * fastest + 0.02).all()


def poses(track) -> np.ndarray:
    return np.column_stack((track.x_m, track.y_m, track.heading_rad))


def check_contact(behavior: BehaviorSpec, made: Plan) -> None:
    """The contact told is the first overlap of any two, on the sides that the shared polygon lies on."""
    tracks = {t.actor: t for t in made.trajectories}
    size = {a.id: size_m(a) for a in behavior.actors}
    names = sorted(tracks)
    firsts = {}
    for i, a in enumerate(names):
        for b in names[i + 1 :]:
            hits = np.flatnonzero(box_gaps(poses(tracks[a]), size[a], poses(tracks[b]), size[b]) <= 0)
            if len(hits):
                firsts[a, b] = int(hits[0])
    if made.contact is None:
        assert not firsts
        return
    pair = (made.contact.actor, made.contact.other)
    k = round(made.contact.t_s / STEP_S)
    assert firsts[pair] == k == min(firsts.values())
    one, two = (Box(*(float(v) for v in poses(tracks[x])[k]), *size[x]) for x in pair)
    assert (contact_area(one, two), contact_area(two, one)) == (made.contact.actor_area, made.contact.other_area)
    if made.realised:
        first = behavior.contacts[0]
        declared = {first.striker: first.striker_area, first.struck: first.struck_area}
        assert {pair[0]: made.contact.actor_area, pair[1]: made.contact.other_area} == declared


def check_driven(behavior: BehaviorSpec, made: Plan) -> None:
    """Every wheeled actor keeps the limits of driving until it is touched; nothing lies in anything afterwards."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    touches = first_touches(made.trajectories, sizes)
    for actor, track in zip(behavior.actors, made.trajectories, strict=True):
        slides = any(note.startswith(actor.id) and SLIDES in note for note in made.notes)
        if actor.record.wheeled and not slides:
            seen = driving_peaks(track, sizes[actor.id][0], touches.get(actor.id), backing=actor.maneuver == "backing")
            assert not seen.excesses(behavior.surface), (actor, made.notes)
    poles = {a.id for a in behavior.actors if a.record.thing and max(size_m(a)) <= NARROW_M}
    others = [track for track in made.trajectories if track.actor not in poles]
    assert deepest_overlap(others, sizes)[0] < 0.06
    assert deepest_overlap(made.trajectories, sizes)[0] < DEEPEST_M + 0.15
    assert deepest_overlap(made.trajectories, sizes, at_rest=True)[0] == 0


@pytest.mark.slow
@settings(max_examples=EXAMPLES, deadline=None)
@given(behaviors())
def test_any_behavior_gives_finite_continuous_motion_on_one_clock(case):
    layout, behavior = case
    made = plan(behavior, network(layout))
    check(behavior, made)
    check_contact(behavior, made)


@pytest.mark.parametrize(
    "pairs",
    [
        [("V1", "V1"), ("B1", "B1")],
        [("V1", "B1"), ("V1", "V1"), ("V1", "B1")],
        [("V1", "V2"), ("B1", "O1"), ("V1", "B1")],
        [("V1", "V2"), ("V1", "O1"), ("V2", "O1"), ("V1", "O1")],
    ],
)
def test_odd_orders_of_contacts_leave_nobody_out(pairs):
    kinds: dict[str, ActorKind] = {"V1": "car", "V2": "car", "B1": "bicycle", "O1": "object"}
    actors = [
        {"id": n, "kind": k, "road": "N", "direction": "forward", "maneuver": "straight"} for n, k in kinds.items()
    ]
    contacts = [{"striker": a, "struck": b, "striker_area": "front", "struck_area": "back"} for a, b in pairs]
    behavior = BehaviorSpec.model_validate({"actors": actors, "contacts": contacts})
    check(behavior, plan(behavior, network("bend")))


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6))
def test_drawn_crashes_keep_every_promise(seed):
    _, layout, behavior = draw_scene(seed)
    made = plan(behavior, network(layout))
    check(behavior, made)
    check_contact(behavior, made)
    check_driven(behavior, made)


@pytest.mark.parametrize("seed", spread(range(3000, 3060), 5))
def test_drawn_crashes_can_be_driven(seed):
    _, layout, behavior = draw_scene(seed)
    check_driven(behavior, plan(behavior, network(layout)))


@settings(max_examples=5, deadline=None)
@given(behaviors())
def test_the_same_behavior_is_planned_alike(case):
    layout, behavior = case
    first, second = plan(behavior, network(layout)), plan(behavior, network(layout))
    assert first.notes == second.notes
    for a, b in zip(first.trajectories, second.trajectories, strict=True):
        assert np.array_equal(poses(a), poses(b))


def share_realised(seeds: range) -> float:
    return float(np.mean([plan(b, network(name)).realised for _, name, b in map(draw_scene, seeds)]))


def test_nearly_every_drawn_crash_is_realised():
    assert share_realised(range(40)) >= 0.97


@pytest.mark.slow
def test_97_percent_of_many_drawn_crashes_are_realised():
    assert share_realised(range(1000, 1000 + many(150, 600))) >= 0.97


def turned(track, k: int) -> float:
    return math.degrees(np.unwrap(track.heading_rad[: k + 1])[-1] - track.heading_rad[0])


@pytest.mark.parametrize("seed", spread(range(200, 260), 5))
def test_maneuvers_show_before_contact(seed):
    """As an observer tells them: standing moves under 2 m, a turn turns over 12 degrees its way."""
    _, layout, behavior = draw_scene(seed)
    made = plan(behavior, network(layout))
    k = round(made.contact.t_s / STEP_S)
    involved = {behavior.contacts[0].striker, behavior.contacts[0].struck}
    for actor, track in zip(behavior.actors, made.trajectories, strict=True):
        if actor.id not in involved:
            continue
        moved = math.hypot(track.x_m[k] - track.x_m[0], track.y_m[k] - track.y_m[0])
        if actor.maneuver in ("stopped", "parked"):
            assert moved < 2.0
        elif actor.maneuver == "straight" and actor.kind != "pedestrian":
            assert moved >= 2.0
        elif actor.maneuver in ("turn_left", "u_turn"):
            assert turned(track, k) > 12
        elif actor.maneuver == "turn_right":
            assert turned(track, k) < -12
