"""Vehicles that are struck later find a place, wherever they can stand at all."""

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.planner.plan import plan
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.behavior.passers_by import with_passers_by
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.roads.layout import road_spec

_STALLS = (
    "V1 was southbound on a two-lane private drive. V2 and V3 were parked in the parking lot of a house. V1 left its "
    "lane to the left. The left side of V1 contacted the back of V2. The front of V1 contacted the left side of V3."
)


def test_a_vehicle_that_can_only_stand_askew_still_gets_a_place() -> None:
    roads = read(_STALLS).roads
    spec = road_spec(layout_of_facts(roads))
    made = compile_network(plain_xml(spec), spec)
    assert made.net_xml is not None
    planned = plan(behavior_of_facts(roads.crash, spec), parse_net(made.net_xml))
    assert {"V1", "V2", "V3"} <= {one.actor for one in planned.trajectories}


def test_traffic_that_passes_by_does_not_stop_for_a_crash_beside_its_way() -> None:
    facts = read("The AV was stopped on northbound Elm Street to yield to oncoming traffic when a van struck its rear.")
    spec = road_spec(layout_of_facts(facts.roads))
    made = compile_network(plain_xml(spec), spec)
    assert made.net_xml is not None
    behavior = with_passers_by(behavior_of_facts(facts.crash, spec), facts, spec)
    planned = plan(behavior, parse_net(made.net_xml))
    assert next(one for one in planned.trajectories if one.actor == "V3").speed_mps[-1] > 5.0
