"""A kind of actor that only these tests know goes through everything by its one record and its word."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from flows.player.play_any_xosc import _kind
from flows.player.player_data import Mover, _actor
from plugins.validator.drivable import Drivable
from research.generator.crash import world
from research.renderer import icons
from research.renderer.boxes import Pose
from research.renderer.pen import Pen
from research.renderer.poses import Track
from sgcad_core.case.records import CrashReport, Evidence, RoadNetwork, Scenario
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.playing.timed_motion import BoxShape
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.formats.xml import parse_xml
from sgcad_core.handover.script import Script, staging_for
from sgcad_core.kinds import ACTORS, learned_actors, mass_kg
from sgcad_core.kinds.actors import Axles
from sgcad_core.reading.actors import makes
from sgcad_core.records.answer_schema import trained_schema
from sgcad_core.records.specs import ActorKind, BehaviorSpec, Leg, RoadLayout
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec

BUGGY = "dune_buggy"
TEXT = "V1 was traveling north. V2 was traveling west. They struck each other at the intersection."


@pytest.fixture
def buggy(monkeypatch: pytest.MonkeyPatch) -> str:
    record = replace(
        ACTORS["golf_cart"], id=BUGGY, called="a dune buggy", length_m=3.3, width_m=1.6, height_m=1.55, mass_kg=650.0,
        learned=False, pace_mps=None, category="truck", max_speed_mps=33.0, symbol="pickup", blueprint="vehicle.buggy",
    )  # fmt: skip
    monkeypatch.setitem(ACTORS, BUGGY, record)
    monkeypatch.setitem(makes.BODY_WORDS, "dune buggy", BUGGY)
    return BUGGY


@pytest.fixture(scope="module")
def crossing() -> RoadNetwork:
    legs = tuple(Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "NESW")
    spec = road_spec(RoadLayout(legs=legs))
    return compile_network(plain_xml(spec), spec)


@pytest.fixture
def crash(buggy: str, crossing: RoadNetwork) -> Scenario:
    same = {"direction": "forward", "maneuver": "straight"}
    return compile_scenario(BehaviorSpec.model_validate({
        "actors": [{"id": "V1", "kind": buggy, "road": "S", "exit_road": "N", **same},
                   {"id": "V2", "kind": "tram", "road": "E", "exit_road": "W", **same},
                   {"id": "B1", "kind": "e_scooter", "road": "W", "exit_road": "E", **same}],
        "contacts": [{"striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "left"}],
    }), crossing)  # fmt: skip


def test_it_is_read(buggy: str) -> None:
    assert makes.kind_of("a red dune buggy", None) == (buggy, True)


def test_it_is_planned_written_and_played(crash: Scenario, crossing: RoadNetwork) -> None:
    assert crash.actors[0].type == BUGGY
    assert (crash.actors[0].length_m, crash.actors[0].width_m) == (3.3, 1.6)
    root = parse_xml(crash.xosc, "xosc")
    made = {e.get("name"): e for e in root.iterfind(".//ScenarioObject")}["V1"].find("Vehicle")
    assert made.get("vehicleCategory") == "truck"
    assert float(made.get("mass")) == mass_kg(BUGGY, 3.3) == 650.0
    assert float(made.find("Performance").get("maxSpeed")) == 33.0
    assert made.find("Axles") is not None
    assert {t.actor for t in play(crash.xosc, crossing.xodr)} == {"V1", "V2", "B1"}


def test_its_motion_is_checked_and_it_can_be_the_ego(crash: Scenario, crossing: RoadNetwork) -> None:
    tracks = play(crash.xosc, crossing.xodr)
    turned = [t.model_copy(update={"heading_rad": t.heading_rad + np.pi / 2}) for t in tracks]
    sideways = crash.model_copy(update={"planned": tuple(turned)})
    evidence = Evidence(report=CrashReport(case="c", narrative=TEXT), network=crossing)
    found = Drivable.model_validate({"odd": "doubt"}).findings(sideways, evidence)
    assert any("V1" in finding.where for finding in found)
    script = Script("made", crash.actors, tuple(tracks), LaneGraph({}, (), {}), roles={"V1": "initiator"})
    assert script.ego_of("initiator") == "V1"
    assert staging_for(script, "V1").ego == "V1"


def test_it_is_shown_in_the_player_and_in_the_drawing(crash: Scenario, crossing: RoadNetwork) -> None:
    track = next(t for t in play(crash.xosc, crossing.xodr) if t.actor == "V1")
    shown = _actor(Mover(crash.actors[0], track, "#fff"))
    assert (shown["type"], shown["outline"]) == (BUGGY, "cab")
    pen = Pen(Random(0), 120, 120, 6.0, 0.0, (0.0, 0.0))
    drawn = Track(world.Actor("V1", BUGGY, 0, 4, "straight"), ACTORS[BUGGY].drawn_m)
    icons.vehicle(Random(0), pen, drawn, Pose(0.0, 0.0, 0.0), (150, 150, 150), icons.Look("icon"))
    assert np.asarray(pen.image).std() > 0


def test_people_and_large_models_may_answer_it_and_the_embedded_model_is_asked_as_before(buggy: str) -> None:
    adapter = TypeAdapter(ActorKind)
    assert adapter.validate_python(buggy) == buggy
    assert buggy in adapter.json_schema()["enum"]
    learned = trained_schema(BehaviorSpec)["$defs"]["Actor"]["properties"]["kind"]["enum"]
    assert learned == list(learned_actors())
    assert not {buggy, "golf_cart", "tram", "e_scooter"} & set(learned)


def test_a_kind_that_there_is_not_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValidationError, match=r"Input should be 'car', 'suv',.* or 'e_scooter'"):
        TypeAdapter(ActorKind).validate_python(BUGGY)


@pytest.mark.parametrize(("kind", "axles"), [("car", None), ("pedestrian", ACTORS["car"].axles)])
def test_a_record_that_no_file_could_be_written_of_is_refused(kind: str, axles: Axles | None) -> None:
    with pytest.raises(ValueError, match="give every vehicle axles"):
        replace(ACTORS[kind], axles=axles)


@pytest.mark.parametrize("kind", ACTORS)
def test_files_of_others_are_played_with_the_kind_of_their_category(kind: str) -> None:
    record = ACTORS[kind]
    tag = "Vehicle" if record.axles else "Pedestrian" if record.walks else "MiscObject"
    body = Body("a", BoxShape(4.0, 1.8, 0.0, 0.0), tag, record.category if record.axles else "")
    assert ACTORS[_kind(body)].category == record.category
