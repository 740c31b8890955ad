"""Road networks from templates: the narrative's stated roads, completed by parameters, without a model.

The baseline without a model: narrative -> facts -> layout -> spec -> netconvert. Reads no diagram and no passages;
findings cannot change its answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import Field

from plugins.road_writer._told_layout import no_crash
from sgcad_core.case.records import Context, Finding, Passage, Place, RoadNetwork
from sgcad_core.errors import Refused
from sgcad_core.formats.osm.fit import known_from, laid_on, posted_on_map, settled
from sgcad_core.formats.osm.real_place import axes_of, real_place
from sgcad_core.formats.osm.street_map import maps_in, read_street_map
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.interfaces import Ask, RoadWriter
from sgcad_core.reading.language import rule
from sgcad_core.reading.layout.layout_facts import Defaults, layout_of_facts
from sgcad_core.reading.roads.named_places import named_places
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.told_roads import told_roads
from sgcad_core.roads.layout import LEG_M, road_spec

_CRASH_WORDS = rule("report.crash_words")


class Template(RoadWriter):
    """Draws the roads that the narrative states; parameters fill in lanes, lengths and limits that it leaves out."""

    asks_model: ClassVar[bool] = False
    version: ClassVar[str] = "2"

    lanes_each_way: Annotated[int, Field(ge=1, le=4)] = 1
    """Where no lanes are stated: most roads of police-reported crashes at that are two-lane, two-way."""
    leg_length_m: Annotated[float, Field(ge=60, le=400)] = LEG_M
    """Long enough to reach 40 mph before the junction and to be in view for 7 s."""
    speed_limit_mph: Annotated[int, Field(ge=5, le=85)] = 35
    """Where no limit is posted: the usual one of urban arterials."""

    places: Path | None = None
    """An OpenStreetMap extract (.osm, .osm.gz, .osm.bz2, .osm.pbf), or a folder of them: where the report names streets
    or coordinates that they have, the road is the real one."""

    @property
    def stamp(self) -> str:
        """Names and sizes of the maps. Raises ConfigError where there are none."""
        maps = maps_in(self.places) if self.places else ()
        return "; ".join(f"{extract.name} {extract.stat().st_size}" for extract in maps)

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Writes the network; its `log` begins with the assumptions. Raises Refused (no crash, or no drawing)."""
        gap = context.reading.crash.gap
        if gap and gap.roads_too:
            raise Refused(gap.reason, list(gap.missing))
        return self.network_of(context.narrative, context.reading.roads)

    def network_of(self, narrative: str, facts: RoadFacts) -> RoadNetwork:
        """The network of facts, parameters standing in for what they leave open. Raises as `write` does."""
        if not (facts.crash.vehicles or facts.roads or _CRASH_WORDS.search(narrative)):
            raise no_crash()
        defaults = Defaults(self.lanes_each_way, self.speed_limit_mph)
        place = self._place(narrative, facts, defaults)
        laid = laid_on(place, facts, axes_of(narrative))
        layout, place = settled(layout_of_facts(facts, defaults, laid=laid), place)
        spec = road_spec(layout, self.leg_length_m)
        told = posted_on_map(told_roads(facts, spec), place)
        network = compile_network(plain_xml(spec, told, place.origin if place else None), spec)
        notes = [f"template: {note}; a default stands in" for note in facts.notes if not known_from(place, note)]
        if open_limits := [name for name, road in told.items() if not road.posted]:
            notes.append(f"template: no posted speed limit is told of {', '.join(open_limits)}; the map leaves it open")
        log = "\n".join([*notes, network.log]).strip()
        return network.model_copy(update={"layout": layout, "place": place, "log": log})

    def _place(self, narrative: str, facts: RoadFacts, defaults: Defaults) -> Place | None:
        """The report's place in the maps; None where no maps are given. Raises ConfigError, MissingTool."""
        if self.places is None:
            return None
        named = named_places(narrative)
        maps = [read_street_map(extract) for extract in maps_in(self.places)] if named.some else []
        return real_place(narrative, facts, layout_of_facts(facts, defaults, as_counted=True), maps)
