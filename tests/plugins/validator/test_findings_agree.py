"""What the narrative checks say of wrong answers to one report never excludes what they say of others, and a right
answer is asked nothing: a model that does as it is told cannot be sent in a circle."""

from functools import cache
from itertools import combinations

import pytest
import yaml

from plugins.backbone.scripted import ASKED
from plugins.validator.behavior_narrative import BehaviorNarrative
from plugins.validator.road_narrative import RoadNarrative
from research.benchmarks.scenes.recorded import REPORTS
from sgcad_core.asking.repairs import exclude, put_to_model
from sgcad_core.case.records import CrashReport, Evidence, RoadNetwork, Scenario
from sgcad_core.execution.scenario import actor_infos
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.reading.text.privacy import redact
from sgcad_core.records.specs import BehaviorSpec, Contact, RoadSpec

QUICK = ("left_across_signal", "head_on_centerline", "rear_end_stopped", "near_braking", "pedestrian_midblock")
MANEUVERS = ("straight", "stopped", "turn_left", "turn_right", "lane_change_left", "crossing_centerline", "backing")
AREAS = ("front", "back", "left", "right")


@cache
def dialogues():
    files = [f for f in sorted((REPORTS.parent / "answers").glob("*.yaml")) if f.name != ASKED]
    return {one["case"]: one for file in files for one in yaml.safe_load(file.read_text())}


def right(name):
    """The report, the network of the right road, and the right behavior."""
    told = dialogues()[name]
    spec = RoadSpec.model_validate(told["road"][-1])
    report = CrashReport(case=name, narrative=redact((REPORTS / f"{name}.txt").read_text()))
    return report, compile_network(plain_xml(spec), spec), BehaviorSpec.model_validate(told["scenario"][-1])


def wrong_behaviors(behavior):
    """The behavior with one thing wrong, or two."""
    for i, actor in enumerate(behavior.actors):
        changes = [{"maneuver": m} for m in MANEUVERS if m != actor.maneuver]
        changes += [{"direction": "backward" if actor.direction == "forward" else "forward"}, {"speed_mph": 99}]
        changes += [{"direction": "backward" if actor.direction == "forward" else "forward", "maneuver": "stopped"}]
        for change in changes:
            yield behavior.model_copy(update={"actors": (
                *behavior.actors[:i], actor.model_copy(update=change), *behavior.actors[i + 1 :]
            )})  # fmt: skip
    yield behavior.model_copy(update={"contacts": (), "near_crash": None})
    for contact in behavior.contacts[:1]:
        swapped = Contact(striker=contact.struck, struck=contact.striker, striker_area="front", struck_area="back")
        sides = [contact.model_copy(update={"striker_area": a, "struck_area": b}) for a in AREAS for b in AREAS]
        yield from (behavior.model_copy(update={"contacts": (one,)}) for one in (swapped, *sides))


def wrong_roads(spec):
    """The network with one thing wrong."""
    for i, road in enumerate(spec.roads):
        for change in ({"lanes_forward": road.lanes_forward + 2}, {"lanes_backward": 0}):
            roads = (*spec.roads[:i], road.model_copy(update=change | {"turns_forward": ()}), *spec.roads[i + 1 :])
            yield spec.model_copy(update={"roads": roads})
    for control in ("none", "signal", "all_way_stop"):
        yield spec.model_copy(update={"nodes": tuple(n.model_copy(update={"control": control}) for n in spec.nodes)})


def scenario(behavior):
    return Scenario(behavior=behavior, actors=actor_infos(behavior))


def said(artifact, report, network):
    check = BehaviorNarrative() if isinstance(artifact, Scenario) else RoadNarrative()
    return put_to_model(check.findings(artifact, Evidence(report=report, network=network)))


NAMES = [pytest.param(n, marks=[] if n in QUICK else [pytest.mark.slow]) for n in dialogues()]


@pytest.mark.parametrize("name", NAMES)
def test_findings_about_a_behavior_never_exclude_each_other(name):
    report, network, behavior = right(name)
    assert said(scenario(behavior), report, network) == ()
    found = {f.model_dump_json(): f for one in wrong_behaviors(behavior) for f in said(scenario(one), report, network)}
    assert len(found) >= 2
    assert [(a.line(), b.line()) for a, b in combinations(found.values(), 2) if exclude(a, b)] == []


@pytest.mark.parametrize("name", NAMES)
def test_findings_about_roads_never_exclude_each_other(name):
    report, network, _ = right(name)
    assert isinstance(network, RoadNetwork)
    assert network.spec is not None
    assert said(network, report, None) == ()
    wrong = [compile_network(plain_xml(spec), spec) for spec in list(wrong_roads(network.spec))[:6]]
    found = [f for one in wrong for f in said(one, report, None)]
    assert [(a.line(), b.line()) for a, b in combinations(found, 2) if exclude(a, b)] == []
