"""Rules first; the drawing is asked for a junction only where the narrative tells none."""

from __future__ import annotations

import io
import json

import pytest
from PIL import Image

from plugins.road_writer.fused import Fused
from plugins.road_writer.template import Template
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net, segments
from sgcad_core.records import Context, Diagram, Generation, Query, RoadNetwork

OPEN_ROAD = "V1 was traveling north on a two-lane, two-way road. V2 was traveling south on the same road. V1 struck V2."
AT_JUNCTION = OPEN_ROAD + " The crash occurred at a four-leg intersection with a two-lane road that ran east and west."


def diagram() -> Diagram:
    out = io.BytesIO()
    Image.new("RGB", (40, 30), "white").save(out, "PNG")
    return Diagram(png=out.getvalue(), width_px=40, height_px=30)


class Model:
    """Answers with legs and keeps what it was asked."""

    def __init__(self, answer: str) -> None:
        self.answer, self.asked = answer, []

    def __call__(self, context: Context, query: Query) -> Generation:
        self.asked.append((context, query))
        return Generation(text=self.answer)


def legs(*bearings: str, kind: str = "road", lanes: int = 1) -> str:
    some = [{"bearing": b, "lanes_in": lanes, "lanes_out": 1, "kind": kind if b in "EW" else "road"} for b in bearings]
    return json.dumps({"legs": some})


def write(narrative: str, answer: str, drawn: bool = True, **fields: object) -> tuple[RoadNetwork, Model]:
    model = Model(answer)
    context = Context(narrative=narrative, diagrams=(diagram(),) if drawn else ())
    return Fused.model_validate(fields).write(context, (), (), model, 1), model


def intersections(network: RoadNetwork) -> int:
    assert network.net_xml, network.log
    return network_figures(parse_net(network.net_xml)).intersections


@pytest.mark.parametrize("beside", [("E",), ("W",), ("E", "W")])
def test_a_junction_that_only_the_drawing_shows_is_drawn(beside: tuple[str, ...]) -> None:
    network, model = write(OPEN_ROAD, legs("N", "S", *beside, lanes=2))
    assert intersections(network) == 1
    assert network.net_xml is not None
    assert len(segments(parse_net(network.net_xml))) == 2 + len(beside)
    assert network.log.startswith("drawing: a junction that the text does not tell")
    assert model.asked[0][0].narrative == ""


def test_the_narrative_goes_along_where_it_is_asked_for() -> None:
    _, model = write(OPEN_ROAD, legs("N", "S", "E"), evidence="report")
    assert model.asked[0][0].narrative == OPEN_ROAD


def test_a_told_junction_is_not_asked_about() -> None:
    network, model = write(AT_JUNCTION, legs("N", "S"))
    assert not model.asked
    assert intersections(network) == 1


def test_without_a_drawing_nobody_is_asked() -> None:
    network, model = write(OPEN_ROAD, legs("N", "S", "E"), drawn=False)
    assert not model.asked
    assert intersections(network) == 0


@pytest.mark.parametrize(
    "answer",
    [
        legs("N", "S"),
        legs("E", "W"),
        legs("E", "W", "N"),
        '{"refuse": "?", "missing": []}',
        "{}",
    ],
)
def test_a_drawing_that_does_not_fit_the_narrative_changes_nothing(answer: str) -> None:
    network, model = write(OPEN_ROAD, answer)
    told = Template().write(Context(narrative=OPEN_ROAD), (), (), model, 1)
    assert network.net_xml == told.net_xml


def test_a_driveway_stays_one() -> None:
    network, _ = write(OPEN_ROAD, legs("N", "S", "E", kind="driveway"))
    assert intersections(network) == 1
    assert network.spec is not None
    assert any(road.lanes_forward == road.lanes_backward == 1 for road in network.spec.roads)


@pytest.mark.parametrize(("seen", "drawn"), [("NE", "E"), ("SE", "E"), ("NW", "W"), ("SW", "W")])
def test_a_slanted_leg_is_drawn_at_a_right_angle(seen: str, drawn: str) -> None:
    network, _ = write(OPEN_ROAD, legs("N", "S", seen))
    assert network.spec is not None
    assert any(road.id.startswith(drawn) for road in network.spec.roads)
    assert intersections(network) == 1
