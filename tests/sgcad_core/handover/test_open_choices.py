"""Lanes, reactions and light of a family: only where nobody told them, and the crash stays the declared one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.execution.contact import first_contact, realised
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.handover.family.discrete_parameters import LIGHTS, light_of, unvaried
from sgcad_core.handover.family.parameter_priors import open_parameters
from sgcad_core.handover.family.shifted_evasion import delay_of
from sgcad_core.handover.family.variant import basis_of, member, undisturbed
from sgcad_core.handover.parallel_lanes import lane_offsets
from sgcad_core.handover.script import staging_for
from tests.sgcad_core.handover.scenes import LENGTH, STEP, WIDTH, crossing, rear_end

LANES = "".join(
    f'<lane id="A_{k}" index="{k}" speed="20" length="600" width="3.5" shape="-300,{y} 300,{y}"/>'
    for k, y in enumerate((-3.5, 0.0, 3.5))
)
ROAD = parse_net(
    '<net version="1.20"><location netOffset="0,0" convBoundary="0,0,1,1" origBoundary="0,0,1,1" projParameter="!"/>'
    f'<edge id="A" from="a" to="b" priority="-1">{LANES}</edge>'
    '<junction id="a" type="dead_end" x="-300" y="0" incLanes="" intLanes="" shape=""/>'
    '<junction id="b" type="dead_end" x="300" y="0" incLanes="A_0 A_1 A_2" intLanes="" shape=""/></net>'
)
BRAKES = {"field": "vehicles.V2.evasion.brakes", "value": True, "status": "stated"}
LANE = {"field": "vehicles.V1.lane", "value": 2, "status": "stated"}
DARK = {"field": "conditions.light", "value": "dark", "status": "stated"}


def on_road(made):
    """A script of the scenes on a road of three lanes, the middle one along y = 0."""
    return replace(made, graph=ROAD)


def braking(contact_s=6.0, onset_s=4.5, speed=18.0, rate=5.0):
    """The crossing, but V2 (northbound, told to brake, the responder) slows down before the contact."""
    made = crossing(own=10.0, other=speed, contact_s=contact_s)
    track = made.trajectories[1]
    held = np.clip(track.t_s, None, contact_s)
    slowing = np.clip(held - onset_s, 0.0, None)
    gone = speed * held - rate * slowing**2 / 2
    v = np.where(track.t_s < contact_s, speed - rate * slowing, 0.0)
    slowed = track.model_copy(update={"y_m": gone - gone[-1], "speed_mps": v})
    return replace(
        made, trajectories=(made.trajectories[0], slowed), roles={"V1": "initiator", "V2": "responder"}
    )  # fmt: skip


def by_name(made, *facts):
    basis = basis_of(made)
    return {p.name: p for p in open_parameters(made, facts, basis.delays if basis else {})}


# ------------------------------------------------------------------ lanes
def poses(x, y, heading):
    return np.column_stack((x, np.full(len(x), y), np.full(len(x), heading)))


def test_lanes_beside_are_counted_from_the_own_one_to_the_left():
    x = np.linspace(-200, 100, 200)
    assert lane_offsets(ROAD, poses(x, 0.1, 0.0)) == pytest.approx({-1: -3.5, 1: 3.5})
    assert lane_offsets(ROAD, poses(x, -3.4, 0.0)) == pytest.approx({1: 3.5, 2: 7.0})
    assert lane_offsets(ROAD, poses(x[:1], 0.0, 0.0)) == pytest.approx({-1: -3.5, 1: 3.5})


def test_who_drives_against_the_road_off_it_or_turns_has_no_other_lane():
    x = np.linspace(-200, 100, 200)
    assert lane_offsets(ROAD, poses(x, 0.0, math.pi)) == {}
    assert lane_offsets(ROAD, poses(x, 40.0, 0.0)) == {}
    turning = poses(x, 0.0, 0.0)
    turning[:, 2] = np.linspace(0, 0.6, len(x))
    assert lane_offsets(ROAD, turning) == {}


def test_two_that_drive_in_one_direction_change_the_lane_together():
    found = by_name(on_road(rear_end()))["pair_lane_m"]
    assert found.kind == "choice"
    assert found.values == pytest.approx((-3.5, 0.0, 3.5))
    assert found.words == ("1 to the right", "the script's lane", "1 to the left")
    assert sum(found.shares) == pytest.approx(1.0)
    assert {found.value(z) for z in np.linspace(-3, 3, 50)} == set(found.values)
    made = member(basis_of(on_road(rear_end())), {"pair_lane_m": 3.5})
    assert realised(made.declared, first_contact(made.trajectories, made.sizes))
    assert [t.y_m[0] for t in made.trajectories] == pytest.approx([3.5, 3.5])


@pytest.mark.parametrize("lane", [-3.5, 3.5])
def test_whose_line_is_crossed_in_another_lane_is_met_there_at_the_same_time(lane):
    script = on_road(crossing())
    assert "V1_lane_m" in by_name(script)
    assert "V2_lane_m" not in by_name(script)  # northbound: no lane of this road
    made = undisturbed(basis_of(script), {"V1_lane_m": lane})
    contact = first_contact(made.trajectories, made.sizes)
    assert realised(made.declared, contact)
    assert contact.t_s == pytest.approx(6.0, abs=STEP + 1e-9)
    k = round(contact.t_s / STEP)
    assert (made.trajectories[0].y_m[k], made.trajectories[1].y_m[k]) == pytest.approx((lane, lane), abs=0.02)


def test_a_told_lane_is_kept_and_the_manifest_says_why():
    script = on_road(crossing())
    assert "V1_lane_m" not in by_name(script, LANE)
    assert unvaried(script, [LANE], tuple(by_name(script, LANE).values()))["lane"] == "told"
    assert "no other lane" in unvaried(crossing(), [], tuple(by_name(crossing()).values()))["lane"]
    assert "lane" not in unvaried(script, [], tuple(by_name(script).values()))


# ------------------------------------------------------------------ reaction
def test_a_later_reaction_hits_as_much_harder_as_the_way_without_braking_says():
    """v^2 = v0^2 - 2 a (s - v0 d) at the same place: undelayed it is 10.9 m/s, that of the last step before."""
    made = braking()
    basis = basis_of(made)
    delay = basis.delays["V2"]
    for by_s in (delay.low_s, delay.high_s, 0.3):
        late = undisturbed(basis, {"V2_reaction_s": by_s})
        k = round(6.0 / STEP)
        want = math.sqrt(10.875**2 + 2 * 5.0 * 18.0 * by_s)
        y = late.trajectories[1].y_m
        assert (y[k + 2] - y[k + 1]) / STEP == pytest.approx(want, abs=0.6)
        assert (y[20] - y[19]) / STEP == pytest.approx(18.0, abs=0.05)
        assert y[k] == pytest.approx(made.trajectories[1].y_m[k], abs=0.3)


def test_an_undelayed_reaction_is_the_script_and_times_of_samples_rise():
    delay = basis_of(braking()).delays["V2"]
    assert np.allclose(delay.times(0.0), delay.t_s)
    for by_s in np.linspace(delay.low_s, delay.high_s, 7):
        assert (np.diff(delay.times(by_s)) > 0).all()
        assert delay.own(delay.times(by_s), by_s) == pytest.approx(delay.t_s, abs=1e-9)
    assert delay.low_s < 0 < delay.high_s


def test_who_does_not_brake_before_the_contact_cannot_do_it_later():
    assert basis_of(crossing()).delays == {}
    early = braking(onset_s=1.0, rate=5.0, speed=18.0)  # stands long before the contact
    way = staging_for(replace(early, declared=None), "V2").way
    assert delay_of(way, 6.0) is None


def test_only_a_told_braking_of_the_responder_varies():
    made = braking()
    told = by_name(made, BRAKES)["V2_reaction_s"]
    assert (told.told, told.field, told.nominal) == ("stated", "vehicles.V2.evasion.brakes", 0.0)
    assert told.low < 0 < told.high <= 0.8
    assert "V2_reaction_s" not in by_name(made)
    initiator = replace(made, roles={"V2": "initiator", "V1": "responder"})
    assert "V2_reaction_s" not in by_name(initiator, BRAKES)
    assert "reaction" in unvaried(made, [], tuple(by_name(made).values()))


def test_a_member_with_another_reaction_is_the_declared_crash():
    basis = basis_of(braking())
    made = [member(basis, {"V2_reaction_s": d}) for d in (-0.2, 0.3, 0.6)]
    assert all(m is not None and realised(m.declared, first_contact(m.trajectories, m.sizes)) for m in made)


# ------------------------------------------------------------------ light
def test_light_is_drawn_where_it_is_not_told_and_moves_nobody():
    light = by_name(crossing())["light"]
    assert light.words == LIGHTS
    assert "light" not in by_name(crossing(), DARK)
    assert light_of({"light": 3.0}) == "dark"
    assert light_of({}) is None
    basis = basis_of(crossing())
    day, dark = (undisturbed(basis, {"light": k}) for k in (0.0, 3.0))
    for a, b in zip(day.trajectories, dark.trajectories, strict=True):
        assert np.array_equal(a.x_m, b.x_m)


def test_shares_are_met_by_the_quantiles_of_a_choice():
    light = by_name(crossing())["light"]
    drawn = [light.value(z) for z in np.random.default_rng(1).standard_normal(4000)]
    for value, share in zip(light.values, light.shares, strict=True):
        assert drawn.count(value) / 4000 == pytest.approx(share, abs=0.02)


def test_boxes_of_the_scenes_are_as_the_tests_take_them():
    assert (LENGTH, WIDTH) == (4.7, 1.8)
