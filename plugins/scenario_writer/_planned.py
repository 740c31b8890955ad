"""What the writers share whose scenarios are planned by code: the form of the file, and the roads of a network."""

from __future__ import annotations

from abc import ABC

from sgcad_core.case.records import RoadNetwork
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_ENCODING, DEFAULT_VERSION, Encoding, Version
from sgcad_core.formats.sumo.graph_spec import spec_of_graph
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import ScenarioWriter
from sgcad_core.records.specs import RoadSpec


class PlannedWriter(ScenarioWriter, ABC):
    """A writer whose scenario is planned by code and written as OpenSCENARIO."""

    openscenario: Version = DEFAULT_VERSION
    """The version to write: 1.0 (which CARLA's runner reads) to 1.3."""
    encoding: Encoding = DEFAULT_ENCODING
    """timed: polylines that every player replays alike; events: maneuvers and triggers that people edit by hand."""


def roads_of(network: RoadNetwork) -> RoadSpec:
    """The network's spec, else one read back from its net.xml. Raises InvalidOutput if the network has neither."""
    if network.spec is not None:
        return network.spec
    if network.net_xml is None:
        raise InvalidOutput("the road network has no net.xml: no road to place an actor on")
    return spec_of_graph(parse_net(network.net_xml))
