"""Edits applied to a writer's artifacts: network and scenario are compiled again where the edits differ from them.

Works on any artifact that carries its spec (`RoadNetwork.spec`, `Scenario.behavior`); one that carries none passes
as it is, and `standing` says so. Knows how specs become files; no writer and no config.
"""

from __future__ import annotations

from collections.abc import Sequence

from sgcad_core.case.records import RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_ENCODING, DEFAULT_VERSION, Encoding, Version
from sgcad_core.formats.sumo.graph_spec import spec_of_graph
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.reading_with_acts import with_acts
from sgcad_core.reading.roads.told_roads import told_roads
from sgcad_core.records.edits import Edit, values
from sgcad_core.records.specs import RoadSpec
from sgcad_core.revision.actors import behavior_with_edits
from sgcad_core.revision.roads import roads_with_edits

_finding = FindingFactory("facts")


def apply_road_edits(network: RoadNetwork, reading: Reading, edits: Sequence[Edit]) -> RoadNetwork:
    """The network with the edits of its roads; the same one where nothing differs or it carries no spec."""
    given = {field: value for field, value in values(edits).items() if field.startswith(("roads.", "junction."))}
    if not given or network.spec is None:
        return network
    spec = roads_with_edits(network.spec, network.layout, given)
    if spec == network.spec:
        return network
    told = {name: road._replace(posted=road.posted or f"roads.{name}.speed_limit_mph" in given)
            for name, road in told_roads(reading.roads, spec).items()}  # fmt: skip
    place = network.place
    made = compile_network(plain_xml(spec, told, place.origin if place else None), spec)
    return made.model_copy(
        update={"source": network.source, "place": place, "log": f"{network.log}\n{made.log}".strip()}
    )


def apply_scenario_edits(
    scenario: Scenario,
    network: RoadNetwork,
    reading: Reading,
    edits: Sequence[Edit],
    version: Version = DEFAULT_VERSION,
    encoding: Encoding = DEFAULT_ENCODING,
) -> Scenario:
    """The scenario with the edits of its behavior, planned anew; the same one where nothing differs.

    Raises InvalidOutput where the edited behavior cannot be planned at all.
    """
    given = {field: value for field, value in values(edits).items() if not field.startswith(("roads.", "junction."))}
    spec = spec_of(network)
    if not given or scenario.behavior is None or spec is None:
        return scenario
    behavior = behavior_with_edits(scenario.behavior, spec, given)
    if behavior == scenario.behavior:
        return scenario
    if not behavior.contacts and not behavior.near_crash and (scenario.behavior.contacts or scenario.near_crash):
        what = "nobody touches anybody any more"
        raise InvalidOutput(what, [_finding(what, "contacts", "", "set contacts.0.striker and contacts.0.struck")])
    told = with_acts(reading, behavior)
    made = compile_scenario(
        behavior, network, version, encoding,
        may_skid=told.lost_control, courses=told.crash.driven, signals=told.signals,
    )  # fmt: skip
    return made.model_copy(update={"notes": (*_kept_notes(scenario, made), *made.notes)})


def spec_of(network: RoadNetwork) -> RoadSpec | None:
    """The roads of a network: as written, else as its .net.xml has them."""
    if network.spec is not None or network.net_xml is None:
        return network.spec
    return spec_of_graph(parse_net(network.net_xml))


def _kept_notes(before: Scenario, after: Scenario) -> list[str]:
    """Notes of the reading, which are not the planner's: those of the former plan hold no longer."""
    return [note for note in before.notes if "not told" in note and note not in after.notes]
