"""Changed roads: one-way streets, single carriageways, mouths of driveways."""

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.crash.configurations import opens
from research.generator.crash.crash import sample_crash
from research.generator.crash.roads import one_way
from research.generator.crash.world import COMPASS, TURN_OF
from research.generator.report import make_report
from research.generator.targets import GUESS
from tests.effort import many


@given(seed=st.integers(0, 100_000))
@settings(max_examples=200, deadline=None)
def test_a_one_way_street_carries_everybody_who_uses_it(seed: int) -> None:
    before = sample_crash(Random(seed))
    crash = one_way(Random(seed), before, 1.0)
    assert [(a.id, a.leg, a.out, a.maneuver) for a in crash.actors] == [
        (a.id, a.leg, a.out, a.maneuver) for a in before.actors
    ]
    assert [leg.bearing for leg in crash.legs] == [leg.bearing for leg in before.legs]
    for actor in crash.actors:
        if actor.kind in ("object", "pedestrian", "bicycle"):
            continue
        leg = crash.leg(actor.leg)
        assert leg is not None
        assert actor.lane is not None
        assert actor.lane <= leg.lanes_in
        alone = sum(other.leg == actor.leg and bool(other.lane) for other in crash.actors) == 1
        if alone and actor.maneuver == "turn_left" and not leg.two_way:
            assert actor.lane == leg.lanes_in
        out = crash.leg(actor.out) if actor.out is not None else None
        assert actor.out is None or (out is not None and out.lanes_out)
    for leg, old in zip(crash.legs, before.legs, strict=True):
        assert leg == old or leg.control == "none" or leg.lanes_in
        assert len(leg.turns_in) in (0, leg.lanes_in)
        for use in leg.turns_in:
            assert all(opens(crash, leg.bearing + TURN_OF[way]) for way in use.split("_"))


def test_some_one_way_streets_meet_two_way_ones_and_some_end_at_a_t() -> None:
    changed = [one_way(Random(seed), sample_crash(Random(seed)), 1.0) for seed in range(300)]
    found = [
        (crash.layout, len({leg.two_way for leg in crash.legs if leg.kind == "road"}))
        for crash in changed
        if any(leg.kind == "road" and not leg.two_way for leg in crash.legs)
    ]
    assert {("four", 2), ("t", 2), ("plain", 1), ("driveway", 1)} <= set(found)


@pytest.mark.slow
def test_one_carriageway_is_drawn_of_some_divided_roads() -> None:
    found = 0
    for seed in range(many(1500, 2500)):
        report = make_report(seed, length=0.1, modes={"both": 1.0})
        if not report.crash.one_way or "divided" not in report.narrative or len(report.road["legs"]) != 2:
            continue
        ways = [(leg["lanes_in"], leg["lanes_out"], leg["median"]) for leg in report.road["legs"]]
        axes = {f"lanes.{leg.bearing % 4}" for leg in report.crash.legs}
        if axes & report.stated:  # a road that was one-way from the first
            continue
        found += 1
        assert sorted(bool(into) for into, _, _ in ways) == [False, True]
        assert all(median == "none" for _, _, median in ways)
        assert axes <= report.drawn
    assert found > 5


def test_drawings_show_driveways_that_the_narrative_passes_over() -> None:
    reports = [make_report(s, length=0.1, modes={"both": 1.0}) for s in range(600)]
    several = [r for r in reports if len(r.crash.accesses) > 1]
    assert 10 < len(several) < 100
    for report in several:
        drawn = [(COMPASS[a.leg], a.side, a.kind) for a in report.crash.accesses]
        told = [(a["leg"], a["side"], a["kind"]) for a in report.road["accesses"]]
        assert sorted(told) == sorted(drawn)
        assert len({leg for leg, _, _ in drawn}) == len(drawn)
        assert all(report.weight(("accesses", i, "distance_m")) == GUESS for i in range(len(told)))
    short = [leg.bearing for r in reports for leg in r.crash.legs if leg.mouth is not None]
    assert len(short) > 10
    assert not any(a.leg == leg.bearing and leg.mouth for r in reports for a in r.crash.actors for leg in r.crash.legs)
    for report in (make_report(s, held_out=True, modes={"both": 1.0}) for s in range(200)):
        assert not any(access.mouth for access in report.crash.accesses)
