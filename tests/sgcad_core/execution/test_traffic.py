"""Traffic keeps clear of the crash, is as dense as asked, the same for a seed, and told where there is none."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from plugins.simulator.libsumo import LibSumo
from sgcad_core.case.density import PER_KM
from sgcad_core.case.traffic import CrashScene, Driven
from sgcad_core.errors import InvalidOutput, NoTraffic
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.execution.traffic import CLEAR_M, MOST, traffic_around
from sgcad_core.execution.traffic_demand import demand, nearest_to, open_lanes
from sgcad_core.execution.traffic_ends import FARTHEST_M, PLACE_M, Stretch, whole_motions
from sgcad_core.execution.traffic_signals import shown_to_traffic
from sgcad_core.execution.traffic_written import PLAYED_CLEAR_M, add_traffic
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.plane import box_gaps, first_overlap
from sgcad_core.records.specs import Node, Road, RoadSpec
from sgcad_core.rules.records import RuleScene
from tests.sgcad_core.formats.xosc_samples import CROSSING, crossroads, road, trajectory

DRIVE = LibSumo().drive_traffic


@cache
def scene():
    """A left turn across an oncoming truck, and a pedestrian."""
    made = compile_scenario(CROSSING, crossroads())
    return CrashScene("made", made.actors, made.planned, crossroads().net_xml, made.xosc)


@cache
def dense(seed=3):
    return traffic_around(scene(), "dense", seed, DRIVE)


def sizes(actors):
    return {a.id: (a.length_m, a.width_m) for a in actors}


def test_no_vehicle_comes_near_an_actor_or_touches_another_one():
    made, told = dense(), sizes(scene().actors) | sizes(dense().vehicles)
    assert len(made.vehicles) >= 10
    for track in made.trajectories:
        for actor in scene().trajectories:
            gap = box_gaps(track.pose, told[track.actor], actor.pose, told[actor.actor]).min()
            assert gap > CLEAR_M, (track.actor, actor.actor)
    for a, b in combinations(made.trajectories, 2):
        assert first_overlap(a.pose, told[a.actor], b.pose, told[b.actor]) is None


def test_vehicles_behind_the_crash_stop_for_it():
    made = dense()
    stopped = [t for t in made.trajectories if t.speed_mps[0] > 5.0 and t.speed_mps[-1] < 0.5]
    near = [t for t in stopped if np.hypot(t.x_m[-1], t.y_m[-1]) < 60.0]
    assert near, "of those that come towards the wrecks some wait behind them"


def test_equal_seeds_give_equal_traffic_and_others_do_not():
    again, other = traffic_around(scene(), "dense", 3, DRIVE), dense(4)
    assert again.summary() == dense().summary()
    assert all(np.array_equal(a.pose, b.pose) for a, b in zip(again.trajectories, dense().trajectories, strict=True))
    assert [t.x_m[0] for t in other.trajectories] != [t.x_m[0] for t in again.trajectories]


@given(st.sampled_from(["light", "dense"]), st.integers(0, 500))
def test_demand_has_the_density_and_a_gap_between_vehicles(density, seed):
    graph = parse_net(crossroads().net_xml)
    found = demand(graph, density, 10.0, np.random.default_rng(seed))
    begun = [s for s in found if s.entrant.depart_s == 0]
    km = sum(lane.length_m for _, lane in open_lanes(graph)) / 1000
    assert abs(len(begun) - km * PER_KM[density]) <= len(open_lanes(graph))
    for lane in {s.lane.id: s.lane for s in begun}.values():
        at = sorted(s.entrant.at_m for s in begun if s.lane.id == lane.id)
        assert all(np.diff(at) >= 0.4 * 1000 / PER_KM[density] - 6.0)
    for seed_ in found:
        ways = {(c.from_edge, c.to_edge) for c in graph.connections}
        assert all(step in ways for step in zip(seed_.entrant.route, seed_.entrant.route[1:], strict=False))


def test_of_too_many_those_nearest_to_the_crash_are_taken():
    found = demand(parse_net(crossroads().net_xml), "dense", 60.0, np.random.default_rng(0))
    kept = nearest_to(found, (0.0, 0.0), 5)
    assert len(kept) == 5 < len(found)
    assert max(np.hypot(*s.place()) for s in kept) < 60.0
    assert MOST == 60


def test_a_network_without_a_lane_for_traffic_is_refused():
    ends = {"from_node": "a", "to_node": "b", "lanes_forward": 1, "lanes_backward": 1, "kind": "driveway"}
    spec = RoadSpec(
        nodes=(Node(id="a", x_m=0, y_m=0), Node(id="b", x_m=80, y_m=0)),
        roads=(Road.model_validate({"id": "lot", **ends}),),
    )
    lot = CrashScene("lot", scene().actors, scene().trajectories, compile_network(plain_xml(spec), spec).net_xml)
    with pytest.raises(NoTraffic, match=r"lot: the network has no lane for traffic .*run it without: traffic none"):
        traffic_around(lot, "light", 1, DRIVE)


def test_a_crash_that_nobody_keeps_clear_of_is_refused():
    def into_the_crash(order):
        poses = order.fixtures[0].poses
        return tuple(Driven(e.id, 0, poses) for e in order.entrants)

    with pytest.raises(
        NoTraffic, match=r"no vehicle of light traffic keeps clear .* too near to an actor of the crash"
    ):
        traffic_around(scene(), "light", 1, into_the_crash)


def test_what_the_simulator_leaves_out_is_counted():
    def one_less(order):
        return DRIVE(order)[1:] if len(order.entrants) > 3 else DRIVE(order)

    made = traffic_around(scene(), "light", 1, one_less)
    assert made.removed["found no room"] >= 1
    assert made.wanted == len(made.vehicles) + sum(made.removed.values())


# ------------------------------------------------------------------ in the file
def test_the_file_with_traffic_has_the_same_crash_and_no_other_contact():
    made = add_traffic(scene(), crossroads().xodr, "dense", 3, DRIVE)
    assert xosc_findings(made.xosc, crossroads().xodr) == []
    played = play(made.xosc, crossroads().xodr)
    told = sizes(scene().actors) | sizes(made.traffic.vehicles)
    assert first_contact(played, told) == first_contact(scene().trajectories, sizes(scene().actors))
    crash = {a.id for a in scene().actors}
    for a, b in combinations(played, 2):
        if not {a.actor, b.actor} <= crash:
            assert box_gaps(a.pose, told[a.actor], b.pose, told[b.actor]).min() > 0
    assert PLAYED_CLEAR_M < CLEAR_M


@pytest.mark.slow
def test_traffic_of_a_file_that_has_some_is_put_in_its_place():
    first = add_traffic(scene(), crossroads().xodr, "dense", 3, DRIVE)
    with_some = CrashScene("made", scene().actors, scene().trajectories, scene().net_xml, first.xosc)
    second = add_traffic(with_some, crossroads().xodr, "light", 3, DRIVE)
    names = {t.actor for t in play(second.xosc, crossroads().xodr)}
    assert names == {a.id for a in scene().actors} | {v.id for v in second.traffic.vehicles}


def test_a_file_whose_actors_would_meet_otherwise_is_refused():
    elsewhere = [t.model_copy(update={"x_m": t.x_m + 0.5 * k}) for k, t in enumerate(scene().trajectories)]
    moved = CrashScene("moved", scene().actors, tuple(elsewhere), scene().net_xml, scene().xosc)
    with pytest.raises(InvalidOutput, match="moved: with traffic the first contact would be"):
        add_traffic(moved, crossroads().xodr, "light", 3, DRIVE)


# ------------------------------------------------------------------ beyond the roads
@given(
    st.lists(st.tuples(st.integers(0, 60), st.floats(0.0, 30.0)), min_size=1, max_size=5),
    st.integers(150, 400),
)
def test_beyond_the_roads_vehicles_queue_and_none_is_far_away(entries, rows):
    poses = {k: np.array([[0.0, 0.0, 0.0, v], [v * 0.05, 0.0, 0.0, v]]) for k, (_, v) in enumerate(entries)}
    driven = {str(k): Stretch("in", "out", first, poses[k]) for k, (first, _) in enumerate(entries)}
    for name, whole in whole_motions(driven, rows).items():
        assert whole.shape == (rows, 4)
        assert np.abs(whole[:, 0]).max() <= FARTHEST_M + 2.0
        step = np.diff(whole[:, 0])
        assert (step >= -1e-9).all(), "nobody drives backwards"
        assert np.abs(step / 0.05 - (whole[1:, 3] + whole[:-1, 3]) / 2).max() < 0.4, name


def test_the_first_to_leave_stands_furthest_away():
    pose = np.array([[0.0, 0.0, 0.0, 20.0]])
    driven = {"a": Stretch("i", "o", 0, pose), "b": Stretch("j", "o", 40, pose), "c": Stretch("k", "p", 40, pose)}
    ends = {name: whole[-1, 0] for name, whole in whole_motions(driven, 600).items()}
    assert ends == pytest.approx({"a": FARTHEST_M, "b": FARTHEST_M - PLACE_M, "c": FARTHEST_M})


# ------------------------------------------------------------------ signals
def test_without_a_plan_the_usual_program_begins_so_that_actors_cross_on_green():
    places = {"N": (0, 120), "E": (120, 0), "S": (0, -120), "W": (-120, 0)}
    hub = Node(id="hub", x_m=0, y_m=0, control="signal")
    ends = tuple(Node(id=f"{name}_end", x_m=x, y_m=y) for name, (x, y) in places.items())
    spec = RoadSpec(nodes=(hub, *ends), roads=tuple(road(name, (1, 1)) for name in places))
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml)
    rows = 200
    states = []
    for actors in (
        trajectory("V1", np.linspace(-100, 60, rows), -1.75),
        trajectory("V1", np.full(rows, 1.75), np.linspace(-100, 60, rows), 1.57),
    ):  # fmt: skip
        movers = RuleScene(graph, (actors,), (scene().actors[0].model_copy(update={"maneuver": "straight"}),)).movers
        shown = shown_to_traffic(graph, None, movers, rows)
        assert "no plan of signal hub is told" in shown.notes[0]
        crossed = int(rows * 0.57)
        (link,) = [c for c in graph.connections if c.from_edge == ("W" if not states else "S")
                   and c.direction == "through"]  # fmt: skip
        assert shown.states["hub"][crossed][link.link] in "Gg"
        states.append(shown.states["hub"])
    assert states[0] != states[1]
