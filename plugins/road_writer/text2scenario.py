"""The first level of a hierarchical reading, the scene's layout: a model fills in a form, rules make a map query of it.

Existing maps only: the nearest map of a library is taken unchanged. Rule templates turn the form (a kind of place, its
main road, lanes, control) into legs; the model writes neither roads nor coordinates. Knows no behavior.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from plugins.road_writer._map_search import compiled, library, nearest
from sgcad_core import kinds
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Passage, Query, RoadNetwork
from sgcad_core.interfaces import Ask, RoadWriter
from sgcad_core.records.specs import Compass, Leg, Median, RoadLayout, Spec
from sgcad_core.roads.layout import COMPASS

Place = Literal["straight_road", "curved_road", "t_junction", "crossing", "driveway", "merge"]
SceneControl = Literal["none", "signal", "flashing", "stop", "all_way_stop", "yield"]
_MAIN_CONTROLS: Mapping[str, Literal["signal", "flashing", "stop"]] = {
    "signal": "signal", "flashing": "flashing", "all_way_stop": "stop",
}  # fmt: skip
"""Signs of the minor road only do not stand on the main road."""
LaneCount = Annotated[int, Field(ge=1, le=5)]


class SceneLayout(Spec):
    """The scene as a form to fill in: no coordinates, no roads of the model's own."""

    place: Place
    main_heading: Compass = Field("N", description="a direction in which the main road runs")
    main_lanes: LaneCount = Field(1, description="lanes in each direction of the main road, turn lanes left out")
    main_one_way: bool = Field(False, description="traffic on the main road runs in main_heading only")
    median: Median = "none"
    cross_bearing: Compass | None = Field(None, description="T, driveway, merge: where the joining road lies")
    cross_lanes: LaneCount = Field(1, description="lanes in each direction of the crossing or joining road")
    cross_one_way: bool = False
    control: SceneControl = "none"


class Text2ScenarioRoad(RoadWriter):
    """Asks a model for the scene's layout and takes the nearest map of a library.

    form: scene asks for a `SceneLayout`, layout for a `RoadLayout` (for small models); prompt names the prompt file.
    """

    asks_model: ClassVar[bool] = True
    folder: Path | None = None
    """Folder of maps (.net.xml, .xodr); the project's own twenty if it is not set."""
    form: Literal["scene", "layout"] = "scene"
    prompt: str = Field("text2scenario_scene", pattern=r"^[\w-]+$")

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt."""
        return (self.prompt,)

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Asks, reads, chooses and compiles. Raises InvalidOutput, Refused, ConfigError (a folder without maps)."""
        maps = library(self.folder)
        query = Query(
            task=load_prompt(self.prompt),
            passages=tuple(passages),
            answer_schema=answer_schema(SceneLayout if self.form == "scene" else RoadLayout),
            attempt=attempt,
        )
        answer = ask(context, query).text
        wanted = (
            layout_of_scene(parse_answer(answer, SceneLayout)) if self.form == "scene"
            else parse_answer(answer, RoadLayout)
        )  # fmt: skip
        return compiled(*nearest(maps, wanted))


# ------------------------------------------------------------------ templates
def layout_of_scene(scene: SceneLayout) -> RoadLayout:
    """The template of a kind of place, its slots filled."""
    ahead = COMPASS.index(scene.main_heading)
    main = [_main(scene, COMPASS[ahead], True), _main(scene, COMPASS[(ahead + 4) % 8], False)]
    joining: list[Leg] = []
    match scene.place:
        case "straight_road":
            pass
        case "curved_road":
            main = [leg.model_copy(update={"curve": c}) for leg, c in zip(main, ("left", "right"), strict=True)]
        case "crossing":
            joining = [_cross(scene, COMPASS[(ahead + 2) % 8], True), _cross(scene, COMPASS[(ahead + 6) % 8], False)]
        case "t_junction":
            joining = [_cross(scene, _bearing(scene, 2), True)]
        case kinds.DRIVEWAY:
            joining = [_cross(scene, _bearing(scene, 2), True).model_copy(update={"kind": kinds.DRIVEWAY})]
        case "merge":
            joining = [_ramp(scene, _bearing(scene, 3))]
    legs = {leg.bearing: leg for leg in [*joining, *main]}  # a joining road on the main road's bearing is the main road
    return RoadLayout(legs=tuple(legs.values()))


def _main(scene: SceneLayout, bearing: Compass, front: bool) -> Leg:
    """The leg ahead takes the traffic that runs in main_heading away from the hub."""
    lanes = scene.main_lanes
    inward, outward = (0, lanes) if front else (lanes, 0)
    if not scene.main_one_way:
        inward = outward = lanes
    control = _MAIN_CONTROLS.get(scene.control, "none")
    return Leg(bearing=bearing, lanes_in=inward, lanes_out=outward, median=scene.median, control=control)


def _cross(scene: SceneLayout, bearing: Compass, inward: bool) -> Leg:
    both = not scene.cross_one_way
    return Leg(
        bearing=bearing, lanes_in=scene.cross_lanes if both or inward else 0,
        lanes_out=scene.cross_lanes if both or not inward else 0,
        control="stop" if scene.control == "all_way_stop" else scene.control,
    )  # fmt: skip


def _ramp(scene: SceneLayout, bearing: Compass) -> Leg:
    return Leg(bearing=bearing, lanes_in=scene.cross_lanes, lanes_out=0, kind=kinds.RAMP)


def _bearing(scene: SceneLayout, default: int) -> Compass:
    """Where the joining road lies: the answer's bearing, else to the right of traffic in main_heading."""
    return scene.cross_bearing or COMPASS[(COMPASS.index(scene.main_heading) + default) % 8]
