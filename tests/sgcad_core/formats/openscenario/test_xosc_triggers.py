"""Triggers and priorities fire in the right step."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.playing.player import play
from tests.sgcad_core.formats.xosc_samples import (
    at,
    condition,
    event,
    follow,
    row,
    scenario,
    speed_action,
    timing,
    v1,
    when,
    world,
)

V1 = {"V1": world(0, 0)}


# ------------------------------------------------------------------ triggers
def starts(start, speeds=None, places=None, end=None):
    """When the event sets V1's speed to 33 m/s."""
    motion = v1(scenario(places or V1, event("e", speed_action(33), start), speeds or {"V1": 10}, end=end or at(6)))
    hits = np.flatnonzero(motion.speed_mps == 33)
    return None if not len(hits) else pytest.approx(motion.t_s[hits[0]])


@pytest.mark.parametrize(("start", "when_s"), [
    (at(2), 2.0), (at(2, "greaterThan"), 2.05), (at(2.01), 2.05), (at(0), 0.0),
    (at(2, edge="rising"), 2.0), (at(0, edge="rising"), None), (at(0, "greaterThan", "rising"), 0.05),
    (at(1, "lessThan", "falling"), 1.0), (at(3, "lessThan"), 0.0), (at(1, "equalTo"), 1.0),
    (at(1, edge="risingOrFalling"), 1.0), (at(1, delay=0.5), 1.5), (at(1, edge="rising", delay=0.52), 1.55),
    (at(1) + at(2), 2.0),
])  # fmt: skip
def test_time_conditions_fire_in_the_right_step(start, when_s):
    assert starts(start) == when_s


def apart(kind, freespace, rule, value):
    what = f'relativeDistanceType="{kind}" freespace="{freespace}" rule="{rule}" value="{value}"'
    return f'<RelativeDistanceCondition entityRef="V2" {what}/>'


@pytest.mark.parametrize(("inner", "when_s"), [
    ('<TraveledDistanceCondition value="20"/>', 2.0),
    ('<SpeedCondition rule="greaterThan" value="9"/>', 0.0),
    ('<RelativeSpeedCondition entityRef="V2" rule="greaterThan" value="1"/>', 0.0),
    (f'<ReachPositionCondition tolerance="1">{world(30, 0)}</ReachPositionCondition>', 2.9),
    (f'<DistanceCondition freespace="false" rule="lessThan" value="5.01">{world(30, 0)}</DistanceCondition>', 2.5),
    (f'<DistanceCondition freespace="true" rule="lessThan" value="2.71">{world(30, 0)}</DistanceCondition>', 2.5),
    (apart("longitudinal", "false", "lessThan", 10.01), 3.0),
    (apart("longitudinal", "true", "lessThan", 5.41), 3.0),
    (apart("lateral", "true", "lessThan", 1.21), 0.0),
    (apart("cartesianDistance", "false", "lessThan", 5.001), 3.6),
    (apart("euclidianDistance", "true", "lessOrEqual", 1.2), 3.55),
    ('<CollisionCondition><EntityRef entityRef="V2"/></CollisionCondition>', None),
])  # fmt: skip
def test_entity_conditions_fire_in_the_right_step(inner, when_s):
    assert starts(when(inner), places={"V1": world(0, 0), "V2": world(40, 3)}) == when_s


def test_standing_still_is_timed():
    inner = '<StandStillCondition duration="1"/>'
    stopped = event("stop", speed_action(0), at(1)) + event("go", speed_action(33), when(inner))
    motion = v1(scenario(V1, stopped, {"V1": 10}))
    assert motion.t_s[np.flatnonzero(motion.speed_mps == 33)[0]] == pytest.approx(2.0)


@pytest.mark.parametrize(("rule", "when_s"), [("any", 1.0), ("all", 2.0)])
def test_any_or_all_of_the_triggering_entities_must_do_it(rule, when_s):
    places = {"V1": world(0, 0), "V2": world(0, 9)}
    inner = when('<TraveledDistanceCondition value="10"/>', "V1", "V2", rule=rule)
    assert starts(inner, {"V1": 10, "V2": 5}, places) == when_s


@pytest.mark.parametrize(("kind", "ref", "state", "when_s"), [
    ("event", "first", "endTransition", 2.0), ("event", "story::act::group::maneuver::first", "completeState", 2.0),
    ("action", "first_action", "startTransition", 1.0), ("event", "first", "runningState", 1.0),
    ("act", "act", "runningState", 0.0),
])  # fmt: skip
def test_an_event_may_wait_for_another(kind, ref, state, when_s):
    inner = f'storyboardElementType="{kind}" storyboardElementRef="{ref}" state="{state}"'
    waits = condition(f"<ByValueCondition><StoryboardElementStateCondition {inner}/></ByValueCondition>")
    first = event("first", speed_action(20, "linear", "time", 1), at(1), "parallel")
    motion = v1(scenario(V1, first + event("e", speed_action(33), waits, "parallel"), {"V1": 10}))
    assert motion.t_s[np.flatnonzero(motion.speed_mps == 33)[0]] == pytest.approx(when_s)


def test_an_unknown_storyboard_element_is_named():
    inner = 'storyboardElementType="event" storyboardElementRef="gone" state="completeState"'
    waits = condition(f"<ByValueCondition><StoryboardElementStateCondition {inner}/></ByValueCondition>")
    with pytest.raises(InvalidOutput, match=r"no storyboard element of type 'event'.*found gone.*maneuver::e"):
        play(scenario(V1, event("e", speed_action(3), waits)))


@pytest.mark.parametrize(("priority", "last"), [("override", 5.0), ("parallel", 5.0), ("skip", 20.0)])
def test_priorities_decide_between_events_of_a_maneuver(priority, last):
    first = event("a", speed_action(20, "linear", "time", 2), at(1))
    second = event("b", speed_action(5), at(2, "equalTo"), priority)
    assert v1(scenario(V1, first + second, {"V1": 10})).speed_mps[-1] == pytest.approx(last)


def test_an_event_runs_as_often_as_it_may():
    places = {"V1": world(0, 0)}
    jump = f"<TeleportAction>{world(0, 7)}</TeleportAction>"
    again = when(f'<ReachPositionCondition tolerance="1.01">{world(10, 7)}</ReachPositionCondition>', edge="rising")
    events = event("first", jump, at(0)) + event("e", jump, again, "parallel", count=2)
    x = v1(scenario(places, events, {"V1": 10})).x_m
    assert (np.diff(x) < -5).sum() == 2


def test_a_stopped_act_frees_its_actors():
    events = event("e", follow([(0, 0, 0, 0), (4, 0, 40, 0)], timing()), at(0))
    stop = f"<StopTrigger><ConditionGroup>{at(2)}</ConditionGroup></StopTrigger></Act>"
    motion = v1(scenario(V1, events).replace("</Act>", stop))
    assert row(motion, 2.0)[:2] == pytest.approx((0, 20))
    assert row(motion, 3.0)[:2] == pytest.approx((10, 20)), "keeps speed and heading"
