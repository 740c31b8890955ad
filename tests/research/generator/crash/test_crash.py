"""Sampled crashes: contacts, lanes and maneuvers fit together."""

from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Crash
from research.generator.writer import Writer

seeds = st.integers(0, 10**6)


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_contacts_fit_the_directions(seed: int) -> None:
    crash = sample_crash(Random(seed))
    contact = crash.contacts[0]
    striker, struck = crash.actors[contact.striker], crash.actors[contact.struck]
    if crash.config == "rear_end":
        assert (striker.leg, contact.striker_area, contact.struck_area) == (struck.leg, "front", "back")
    if crash.config == "crossing":
        from_left = (striker.leg - (struck.heading - 2)) % 8 == 0
        assert contact.struck_area == ("left" if from_left else "right")
    if crash.config == "head_on":
        assert (striker.leg - struck.leg) % 8 == 4


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_everyone_has_a_lane_to_start_on_and_one_to_go_to(seed: int) -> None:
    crash = sample_crash(Random(seed))
    for actor in crash.actors:
        leg = crash.leg(actor.leg)
        assert leg is not None
        if actor.id.startswith("V"):
            assert 1 <= (actor.lane or 0) <= leg.lanes_in
            assert actor.out is None or _opens(crash, actor.out)


def _opens(crash: Crash, bearing: int) -> bool:
    leg = crash.leg(bearing)
    return leg is not None and leg.lanes_out > 0


@settings(max_examples=200, deadline=None)
@given(seed=seeds)
def test_lanes_go_on_through_a_plain_road(seed: int) -> None:
    crash = sample_crash(Random(seed))
    if crash.layout == "plain":
        first, second = crash.legs
        assert (first.lanes_in, first.lanes_out) == (second.lanes_out, second.lanes_in)


def test_who_turns_has_often_stopped_or_slowed_before() -> None:
    """Of turning vehicles in real narratives two in five had stopped; then it is told that they went."""
    waited = {True: 0, False: 0}
    for seed in range(700):
        rng = Random(seed)
        crash = sample_crash(rng)
        if crash.config not in ("left_opposite", "left_lateral", "right_into"):
            continue
        writer = Writer(rng, crash, False, 0.1)
        writer.write()
        waited[writer.waited] += 1
        turner = crash.actors[writer.who[0]].id
        assert not writer.waited or f"man.{turner}" in writer.stated
    assert 0.4 < waited[True] / sum(waited.values()) < 0.65


def test_who_waits_to_turn_right_waits_for_what_comes_from_the_left() -> None:
    seen = 0
    for seed in range(1500):
        crash = sample_crash(Random(seed))
        writer = Writer(Random(seed), crash, False, 1.0)
        for actor in crash.actors:
            if actor.maneuver == "turn_right":
                heads = writer._others(actor, left=False)
                seen += len(heads)
                assert heads in ([], [actor.out % 8])  # the way on which it will drive itself
    assert seen > 50


def test_who_goes_on_along_a_bend_negotiates_it() -> None:
    for seed in range(400):
        crash = sample_crash(Random(seed))
        for actor in (actor for actor in crash.actors if actor.vehicle):
            bends = crash.leg(actor.leg).curve != "none"  # type: ignore[union-attr]
            assert not (bends and actor.maneuver == "straight")
