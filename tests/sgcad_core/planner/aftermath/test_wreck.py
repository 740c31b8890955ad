"""What holds of bodies that collide: momentum, energy, rest, and that none lies in another."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.geometry.plane import box_gaps
from sgcad_core.kinds import ACTORS, mass_kg
from sgcad_core.planner.aftermath.crush import DEEPEST_M, NARROW_M
from sgcad_core.planner.aftermath.ground_friction import Drag, apply_friction
from sgcad_core.planner.aftermath.hitch import hitched
from sgcad_core.planner.aftermath.impact import Body, body, collide, compliance, solve
from sgcad_core.planner.aftermath.wreck import Wreck
from sgcad_core.planner.aftermath.wreck_bodies import Mover, center_of, separation, touch_points

CAR = (4.7, 1.8)
DRAG = Drag(4.5, 7.0)
COUNT = 180

number = st.floats(-20, 20)
masses = st.floats(60, 15000)


# ------------------------------------------------------------------ one impact
@settings(max_examples=200, deadline=None)
@given(st.floats(-3, 3), number, number, masses, number, number, masses, st.floats(0, 6.2), st.floats(0, 0.5), number)
def test_an_impact_keeps_momentum_and_gains_no_energy(heading, u1, w1, m1, u2, w2, m2, towards, restitution, spin):
    normal = (math.cos(towards), math.sin(towards))
    a, b = body((0.0, 0.0, heading), CAR, m1), body((2.5 * normal[0], 2.5 * normal[1], 0.4), CAR, m2)
    a.vx, a.vy, b.vx, b.vy, a.spin = u1, w1, u2, w2, spin / 10
    at = (1.2 * normal[0] - 0.4 * normal[1], 1.2 * normal[1] + 0.4 * normal[0])
    before, energy, turning = momentum(a, b), a.energy + b.energy, angular(a, b)
    collide(a, b, at, normal, restitution)
    assert momentum(a, b) == pytest.approx(before, abs=1e-6 * (m1 + m2) * 20)
    assert angular(a, b) == pytest.approx(turning, abs=1e-6 * (m1 + m2) * 60)
    assert a.energy + b.energy <= energy * (1 + 1e-9) + 1e-6
    (ax, ay), (bx, by) = a.velocity_at(*at), b.velocity_at(*at)
    assert (ax - bx) * normal[0] + (ay - by) * normal[1] <= 1e-6


def momentum(*bodies: Body) -> np.ndarray:
    return sum((np.array([x.vx, x.vy]) / x.inverse_mass for x in bodies), np.zeros(2))


def angular(*bodies: Body) -> float:
    return sum((x.x * x.vy - x.y * x.vx) / x.inverse_mass + x.spin / x.inverse_inertia for x in bodies)


def test_restitution_parts_what_meets_head_on() -> None:
    a, b = body((0.0, 0.0, 0.0), CAR, 1000.0), body((4.7, 0.0, 0.0), CAR, 1000.0)
    a.vx = 10.0
    assert collide(a, b, (2.35, 0.0), (1.0, 0.0), 0.2)
    assert (a.vx, b.vx) == pytest.approx((4.0, 6.0))
    assert not collide(a, b, (2.35, 0.0), (1.0, 0.0), 0.2)


def test_who_strikes_a_fixed_body_head_on_stops() -> None:
    a, tree = body((0.0, 0.0, 0.0), CAR, 1500.0), body((2.6, 0.0, 0.0), (0.5, 0.5), None)
    a.vx = 15.0
    collide(a, tree, (2.35, 0.0), (1.0, 0.0))
    assert a.speed < 1e-9
    assert tree.speed == tree.energy == 0.0


def test_an_impulse_of_the_inverse_compliance_changes_the_velocity_as_wanted() -> None:
    a, b = body((0.0, 0.0, 0.3), CAR, 1200.0), body((3.0, 1.0, 1.0), CAR, 900.0)
    at = (1.7, 0.4)
    jx, jy = solve(compliance(a, b, at), (2.0, -1.0))
    b.push(jx, jy, *at)
    a.push(-jx, -jy, *at)
    (ax, ay), (bx, by) = a.velocity_at(*at), b.velocity_at(*at)
    assert (bx - ax, by - ay) == pytest.approx((2.0, -1.0))


def test_what_a_vehicle_tows_adds_to_its_mass() -> None:
    assert mass_kg("car", CAR[0]) == ACTORS["car"].mass_kg
    assert mass_kg("pickup", 11.1) > ACTORS["pickup"].mass_kg + 400
    assert mass_kg("truck", 20.0) > 15000


@settings(max_examples=150, deadline=None)
@given(number, number, st.floats(-3, 3), st.floats(-3, 3))
def test_scalar_gaps_are_those_of_the_arrays(x, y, first, second):
    a, b = body((0.0, 0.0, first), CAR, 1.0), body((x / 3, y / 3, second), (9.0, 2.5), 1.0)
    want = box_gaps(np.array([[0.0, 0.0, first]]), CAR, np.array([[x / 3, y / 3, second]]), (9.0, 2.5))[0]
    assert separation(a, b).gap_m == pytest.approx(want, abs=1e-9)


def test_two_that_meet_face_to_face_touch_in_the_middle() -> None:
    a, b = body((0.0, 0.0, 0.0), CAR, 1.0), body((4.69, 0.0, math.pi), CAR, 1.0)
    assert center_of(touch_points(a, b)) == pytest.approx((2.345, 0.0), abs=0.01)
    assert separation(a, b).normal == pytest.approx((1.0, 0.0))


# ------------------------------------------------------------------ the ground
@settings(max_examples=60, deadline=None)
@given(number, number, st.floats(-4, 4), st.floats(0.5, 8), st.floats(0.5, 8))
def test_whatever_slides_is_at_rest_in_the_time_that_is_left(vx, vy, spin, along, across):
    """Friction of any size: where the ground alone would not do it in four seconds, it is made to, but for a creep."""
    one, step, energies = body((0.0, 0.0, 0.3), CAR, 1500.0), 0.01, [math.inf]
    one.vx, one.vy, one.spin = vx, vy, spin
    for k in range(420):
        apply_friction(one, Drag(along, across), step, max(4.0 - k * step, 0.1))
        energies.append(one.energy)
        assert energies[-1] <= energies[-2]
    assert one.speed < 0.1
    assert abs(one.spin) < 0.05


def test_a_body_stops_as_soon_as_its_friction_says() -> None:
    one = body((0.0, 0.0, 0.0), CAR, 1500.0)
    one.vx = 10.0
    for _ in range(100):
        apply_friction(one, Drag(5.0, 7.0), 0.01, 4.0)
    assert one.vx == pytest.approx(5.0)
    assert one.vy == one.spin == 0


# ------------------------------------------------------------------ all of it
def mover(name: str, at: tuple[float, float, float], velocity: tuple[float, float], **more: object) -> Mover:
    """A box that would go straight on for ever."""
    size, mass = more.get("size", CAR), more.get("mass", 1450.0)
    t = np.arange(COUNT)[:, None] * 0.05
    script = np.array(at) + t * np.array([*velocity, 0.0])
    return Mover(name, body((0.0, 0.0, 0.0), size, mass), script, DRAG)  # type: ignore[arg-type]


def settled(*movers: Mover, hitches: tuple = ()) -> tuple[dict[str, np.ndarray], list]:
    return Wreck(movers, COUNT, hitches).settle()


def deepest(movers: tuple[Mover, ...], poses: dict[str, np.ndarray], k: slice = slice(None)) -> float:
    gaps = [box_gaps(poses[a.name][k], a.body.size, poses[b.name][k], b.body.size) for a, b in combinations(movers, 2)]
    return -float(min((gap.min() for gap in gaps), default=0.0))


@st.composite
def crashes(draw) -> tuple[Mover, ...]:
    """Two to four boxes that start apart and drive at the middle, some standing there."""
    found = []
    for i in range(draw(st.integers(2, 4))):
        angle = i * 1.7 + draw(st.floats(0, 0.8))
        away = draw(st.floats(14, 30)) if i else 0.0
        speed = draw(st.floats(5, 30)) if i else 0.0  # who comes in the last second is not at rest at the end
        at = (away * math.cos(angle), away * math.sin(angle), draw(st.floats(-3, 3)))
        size = draw(st.sampled_from([CAR, (9.0, 2.5), (0.5, 0.6), (2.2, 0.8)]))
        mass = None if i == 1 and draw(st.booleans()) else draw(st.floats(70, 9000))
        velocity = (-speed * math.cos(angle), -speed * math.sin(angle)) if mass else (0.0, 0.0)
        found.append(mover(f"V{i}", at, velocity, size=size, mass=mass))
    return tuple(found)


@settings(max_examples=40, deadline=None)
@given(crashes())
def test_nothing_lies_in_anything_and_all_that_was_touched_comes_to_rest(movers):
    poses, _ = settled(*movers)
    poles = [m for m in movers if m.fixed and max(m.body.size) <= NARROW_M]
    assert deepest(tuple(m for m in movers if m not in poles), poses) < 0.06
    assert deepest(movers, poses) < (DEEPEST_M + 0.15 if poles else 0.06)  # cars crush at poles
    touched = tuple(m for m in movers if m.hit is not None or m.fixed)
    if len(touched) > 1:
        assert deepest(touched, poses, slice(-1, None)) <= 0
    for m in touched:
        assert np.abs(np.diff(poses[m.name][-3:], axis=0)).max() < 0.02


def test_bodies_with_a_told_second_touch_may_come_apart_before_the_first_one_is_over():
    """A corner turns out of the other body within the time for which the touch is held."""
    pair = frozenset({frozenset({"V1", "V2"})})
    movers = (
        mover("V1", (30.3057, 30.1522, -2.35873), (-16.4766, -16.3696)),
        mover("V2", (-13.2701, -3.30397, 0.0861495), (7.31003, 0.631313)),
    )
    wreck = Wreck(movers, COUNT, again=pair, told=pair)
    poses, touches = wreck.settle()
    assert len(wreck.past) > 0
    assert not wreck.blows
    assert len(touches) == len(wreck.past) + len(wreck.touches)
    assert deepest(movers, poses) < 0.06


def test_a_light_body_between_two_heavy_ones_lies_in_neither():
    """Squeezed from both sides: the impulses of one step go back and forth until nobody approaches anybody."""
    movers = (
        mover("P", (0.0, 0.0, 0.0), (0.0, 0.0), size=(2.2, 0.8), mass=70.0),
        mover("A", (-20.0, 0.3, 0.0), (20.0, 0.0), size=(9.0, 2.5), mass=8000.0),
        mover("B", (20.5, -0.3, math.pi), (-20.0, 0.0), size=(9.0, 2.5), mass=8000.0),
    )
    poses, touches = settled(*movers)
    assert {frozenset((t.first, t.second)) for t in touches} >= {frozenset("PA"), frozenset("PB")}
    assert deepest(movers, poses) < 0.06


@pytest.mark.parametrize("gap", [0.8, 0.95, 1.1])
@pytest.mark.parametrize("start", np.linspace(-20.0, -18.6, 6))
def test_a_light_body_that_is_shot_at_a_third_does_not_fly_into_it(gap, start):
    """It stood, out of reach of the third, when the sample began; struck, it crosses a metre and more within it."""
    movers = (
        mover("A", (start, 0.0, 0.0), (29.0, 0.0), size=(9.0, 2.5), mass=9000.0),
        mover("P", (0.0, 0.0, 0.0), (0.0, 0.0), size=(2.2, 0.8), mass=70.0),
        mover("B", (1.1 + gap + 2.35, 0.0, 0.0), (0.0, 0.0), mass=9000.0),
    )
    poses, touches = settled(*movers)
    assert [(t.first, t.second) for t in touches[:2]] == [("A", "P"), ("P", "B")]
    assert touches[1].t_s - touches[0].t_s == pytest.approx(gap / 31.0, abs=0.02)
    assert deepest(movers, poses) < 0.06


@settings(max_examples=30, deadline=None)
@given(st.floats(5, 30), st.floats(-1.2, 1.2), st.floats(-3, 3), st.floats(300, 9000))
def test_energy_grows_only_where_bodies_part_and_never_over_what_they_had(speed, aside, heading, mass):
    movers = (mover("A", (-20.0, 0.0, 0.0), (speed, 0.0)), mover("B", (0.0, aside, heading), (0.0, 0.0), mass=mass))
    wreck = Wreck(movers, COUNT)
    seen: list[float] = []
    parted: list[bool] = []
    resolve = wreck._resolve

    def watched(near, sample, step):  # type: ignore[no-untyped-def]
        held = len(wreck.blows)
        found = resolve(near, sample, step)
        if wreck.touches:
            seen.append(sum(m.body.energy for m in movers))
            parted.append(len(wreck.blows) < held)
        return found

    wreck._resolve = watched  # type: ignore[method-assign]
    wreck.settle()
    assert seen
    assert seen[0] <= movers[0].body.energy + speed**2 * 1450 / 2 * (1 + 1e-9)
    grown = np.diff(seen) > 1e-6 * seen[0] + 1e-6
    assert not (grown & ~np.array(parted[1:])).any()  # what crushes holds, and then parts as one impulse leaves it
    assert max(seen) <= speed**2 * 1450 / 2 * (1 + 1e-9)
    assert seen[-1] == 0.0


def test_a_second_one_is_pushed_into_a_third_in_that_order() -> None:
    movers = tuple(
        mover(f"V{i + 1}", (x, 0.0, 0.0), (v, 0.0)) for i, (x, v) in enumerate([(-30.0, 15.0), (0.0, 0.0), (6.0, 0.0)])
    )
    poses, touches = settled(*movers)
    assert [(t.first, t.second) for t in touches] == [("V1", "V2"), ("V2", "V3")]
    assert poses["V3"][-1, 0] > 6.5
    assert poses["V1"][-1, 0] + 4.7 <= poses["V2"][-1, 0] <= poses["V3"][-1, 0] - 4.7


def test_every_touch_shows_at_a_sample() -> None:
    for speed in np.linspace(3, 33, 16):
        movers = (mover("A", (-20.0, 0.0, 0.0), (speed, 0.0)), mover("B", (0.0, 0.3, 0.2), (0.0, 0.0)))
        poses, touches = settled(*movers)
        k = math.ceil(touches[0].t_s / 0.05 - 1e-6)
        assert box_gaps(poses["A"][k : k + 1], CAR, poses["B"][k : k + 1], CAR)[0] <= 0


def test_a_trailer_swings_behind_its_tractor_and_never_into_it() -> None:
    tractor, trailer = (
        mover("V1", (0.0, 0.0, 0.0), (20.0, 0.0)),
        mover("T1", (-9.65, 0.0, 0.0), (20.0, 0.0), size=(12.0, 2.5)),
    )
    other = mover("V2", (40.0, 1.4, 1.5), (0.0, 0.0), mass=9000.0, size=(9.0, 2.5))
    hitch = hitched(("V1", "T1"), tractor.script[0], trailer.script[0], 3.0)
    movers = (tractor, trailer, other)
    poses, _ = settled(*movers, hitches=(hitch,))
    assert trailer.hit == tractor.hit
    ends = [
        poses[name][:, :2] + local[0] * np.column_stack((np.cos(poses[name][:, 2]), np.sin(poses[name][:, 2])))
        for name, local in (("V1", hitch.on_first), ("T1", hitch.on_second))
    ]
    assert np.hypot(*(ends[0] - ends[1]).T).max() < 0.3
    assert deepest(movers, poses) < 0.06


def test_who_is_not_touched_goes_on_as_it_would() -> None:
    free = mover("V3", (0.0, 50.0, 0.0), (8.0, 0.0))
    poses, touches = settled(
        mover("V1", (-20.0, 0.0, 0.0), (10.0, 0.0)), mover("V2", (0.0, 0.0, 0.0), (0.0, 0.0)), free
    )
    assert len(touches) == 1
    assert np.array_equal(poses["V3"], free.script)
    assert free.hit is None


class _Endless(Wreck):
    """Simulates on to the end of the clock."""

    def _rests(self) -> bool:
        return False


@pytest.mark.parametrize("speed", [4.0, 12.0, 25.0])
def test_what_stands_is_not_simulated_any_longer_and_nothing_changes_by_that(speed, monkeypatch) -> None:
    samples = {Wreck: 0, _Endless: 0}
    whole = Wreck._sample

    def counted(self: Wreck, k: int, pairs) -> None:
        samples[type(self)] += 1
        whole(self, k, pairs)

    monkeypatch.setattr(Wreck, "_sample", counted)
    found = [
        kind((mover("A", (0.0, 0.0, 0.0), (speed, 0.0)), mover("B", (12.0, 0.4, 1.2), (0.0, 0.0))), COUNT).settle()
        for kind in samples
    ]
    assert samples[Wreck] < samples[_Endless]
    assert found[0][1] == found[1][1]
    for name, poses in found[0][0].items():
        assert np.array_equal(poses, found[1][0][name])


# ------------------------------------------------------------------ gentle touches that are told
def test_a_gentle_touch_that_is_told_holds_long_enough_to_be_seen_in_a_file() -> None:
    def gaps(told: frozenset) -> np.ndarray:
        x = 20.0 - 9.0 + np.cumsum(np.full(COUNT, 2.6 * 0.05))
        rolls = np.column_stack((x, np.zeros((COUNT, 2))))
        stands = np.tile([20.0, 0.0, 0.0], (COUNT, 1))
        movers = [Mover(n, body((0.0, 0.0, 0.0), CAR, 1450.0), s, DRAG) for n, s in (("V1", rolls), ("V2", stands))]
        poses, touches = Wreck(movers, COUNT, told=told).settle()
        assert len(touches) == 1
        return box_gaps(poses["V1"], CAR, poses["V2"], CAR)

    told = gaps(frozenset({frozenset({"V1", "V2"})}))
    assert (told < 0).sum() >= 4  # 0.2 s
    assert (gaps(frozenset()) < 0).sum() < (told < 0).sum()
    assert told.min() > -0.05


# ------------------------------------------------------------------ firm things
@pytest.mark.parametrize("hand", [-1.0, 1.0])
def test_a_car_glances_off_a_firm_thing_that_stays(hand: float) -> None:
    size, k = (0.5, 0.5), np.arange(COUNT)
    driven = np.column_stack((0.05 * 12.0 * k, np.zeros((COUNT, 2))))
    tree = np.repeat([[20.0, hand * (CAR[1] / 2 + size[1] / 2 - 0.15), 0.0]], COUNT, axis=0)
    car = Mover("car", body((0.0, 0.0, 0.0), CAR, mass_kg("car", CAR[0])), driven, DRAG)
    thing = Mover("tree", body((0.0, 0.0, 0.0), size, None), tree, DRAG, firm=True)
    poses, touches = Wreck((car, thing), COUNT).settle()
    gaps = box_gaps(poses["car"], CAR, poses["tree"], size)
    assert [{touch.first, touch.second} for touch in touches] == [{"car", "tree"}]
    assert (poses["tree"] == tree).all()
    assert poses["car"][-1, 0] > 25.0
    assert -0.2 < gaps.min() < 0.0 < gaps[-1]
    assert np.sign(poses["car"][-1, 1]) == -hand


def glanced(overlap_m: float, heading: float = 0.0) -> float:
    """The share of its speed that an eastbound car, turned by an angle, keeps 0.2 s behind a firm tree."""
    size, at = (0.5, 0.5), round((20.0 - CAR[0]) / (12.0 * 0.05))
    driven = np.column_stack((0.6 * np.arange(COUNT), np.zeros(COUNT), np.full(COUNT, heading)))
    half = (CAR[0] * abs(math.sin(heading)) + CAR[1] * math.cos(heading)) / 2
    tree = np.repeat([[20.0, half + size[1] / 2 - overlap_m, 0.0]], COUNT, axis=0)
    car = Mover("car", body((0.0, 0.0, heading), CAR, mass_kg("car", CAR[0])), driven, DRAG)
    thing = Mover("tree", body((0.0, 0.0, 0.0), size, None), tree, DRAG, firm=True)
    poses, touches = Wreck((car, thing), COUNT).settle()
    at = round(touches[0].t_s / 0.05)
    return float((poses["car"][at + 5, 0] - poses["car"][at + 4, 0]) / 0.6)


def test_the_deeper_a_firm_thing_is_overlapped_the_more_speed_is_lost_in_passing_it() -> None:
    kept = [glanced(share * CAR[1]) for share in (0.08, 0.17, 0.25)]
    assert kept[0] > kept[1] > kept[2]
    assert 0.3 < kept[2] < 0.55  # half, and what the ground takes
    assert kept[0] > 0.7


def test_a_yawed_car_loses_for_the_share_of_its_width_across_the_way() -> None:
    assert glanced(0.3, 0.6) > glanced(0.3)


# ------------------------------------------------------------------ things that give way
@settings(max_examples=20, deadline=None)
@given(st.floats(6.0, 25.0), st.floats(-0.8, 0.8))
def test_a_post_that_gives_way_falls_within_a_few_metres_and_the_car_goes_on(speed: float, aside: float) -> None:
    driven = np.column_stack((speed * 0.05 * np.arange(COUNT), np.zeros((COUNT, 2))))
    stands = np.repeat([[20.0, aside, 0.0]], COUNT, axis=0)
    car = Mover("V1", body((0.0, 0.0, 0.0), CAR, 1450.0), driven, DRAG)
    post = Mover("O1", body((0.0, 0.0, 0.0), (0.4, 0.4), 60.0), stands, Drag(9.0, 9.0), gives_way=True, falls=True)
    poses, _ = Wreck((car, post), COUNT).settle()
    assert math.dist(poses["O1"][-1, :2], stands[0, :2]) < max(0.6 * speed, 5.0)
    assert poses["V1"][-1, 0] - 17.4 > speed**2 / 2 / DRAG.along * 0.7
    assert box_gaps(poses["V1"], CAR, poses["O1"], (0.4, 0.4)).min() > -0.5
