"""Direct retrieval (OSM-Direct): the real junction nearest to the roads of the report; nothing is drawn.

No model: the narrative's road facts are described in the index's words, and the first junction found is turned to fit
and compiled. A report of a plain road gets a junction too, since the index holds nothing else. Reads the index through
the retriever only.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

from pydantic import Field

from plugins.road_writer._told_layout import Embedder, junction_index, told_layout
from sgcad_core.case.records import Context, Finding, Passage, PlainXml, RoadNetwork
from sgcad_core.errors import ConfigError
from sgcad_core.formats.sumo.graph_spec import spec_of_graph
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.turning import best_turn, turned_network, with_longer_ends
from sgcad_core.interfaces import Ask, Retriever, RoadWriter
from sgcad_core.records.specs import RoadLayout
from sgcad_core.roads.junction_words import JunctionLeg, describe, describe_layout, layout_legs
from sgcad_core.roads.layout import LEG_M


class OsmDirect(RoadWriter):
    """Takes the real junction nearest to the report's roads from an index (`sgcad index build EXTRACT --out FOLDER`).

    model and base_url are those of the embedder, as in the retriever `lancedb`.
    """

    asks_model: ClassVar[bool] = False
    version: ClassVar[str] = "2"

    folder: Path = Path("knowledge")
    """The index; relative to the working directory."""
    embedder: Embedder = "none"
    """none: full text over the words of a description, which junctions of equal legs and lanes share."""
    model: str = ""
    base_url: str = ""
    among: int = Field(1, ge=1, le=50)
    """Of so many found, the one whose legs and lanes fit best; 1 takes the first, as the paper does."""
    leg_length_m: float = Field(LEG_M, ge=0, le=400)
    """Roads that a cut ends sooner run straight on so far, else approaches begin off the road; 0 leaves them."""
    turn: bool = True
    """Turn the junction so that its legs lie as told; else it lies as in the real world, and crashes seldom fit."""

    @property
    def stamp(self) -> str:
        """The index's fingerprint. Raises ConfigError if the folder holds no index."""
        return self._retriever.stamp

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Searches, turns and compiles. Raises Refused (a text without a crash), ConfigError (no junctions)."""
        layout = told_layout(context)
        found, data = self._nearest(layout)
        legs = _legs(data)
        turn = best_turn(legs, layout_legs(layout))[0] if self.turn else 0.0
        network = compile_network(turned_network(with_longer_ends(PlainXml(**data["plain"]), self.leg_length_m), turn))
        spec = spec_of_graph(parse_net(network.net_xml)) if network.net_xml else None
        said = f"osm_direct: {found.id}, turned by {math.degrees(turn):.0f} degrees: {describe(legs, data['control'])}"
        log = f"{said}\n{network.log}".strip()
        return network.model_copy(update={"spec": spec, "source": "openstreetmap", "log": log})

    def _nearest(self, layout: RoadLayout) -> tuple[Passage, dict[str, Any]]:
        found = [(p, json.loads(p.data)) for p in self._retriever.retrieve(describe_layout(layout), "road") if p.data]
        if not found:
            raise ConfigError(
                f"the knowledge base in {self.folder} holds no junction: "
                f"`sgcad index add EXTRACT.osm.pbf --out {self.folder}` takes those of a map in"
            )
        wanted = layout_legs(layout)
        return min(found, key=lambda f: (abs(len(_legs(f[1])) - len(wanted)), best_turn(_legs(f[1]), wanted)[1]))

    @cached_property
    def _retriever(self) -> Retriever:
        return junction_index(self.folder, self.embedder, self.model, self.base_url, self.among)


def _legs(data: dict[str, Any]) -> list[JunctionLeg]:
    return [JunctionLeg(math.radians(leg["angle_deg"]), leg["lanes_in"], leg["lanes_out"]) for leg in data["legs"]]
