"""Files on disk as strangers write them: catalogs, maps, parameter distributions, and what other players let pass."""

from __future__ import annotations

import pytest

from research.benchmarks.scenes.foreign import scenario_files
from sgcad_core.errors import BadInput, InvalidOutput, Unsupported
from sgcad_core.formats.openscenario.reading.files import Variation, play_file, variations
from tests.sgcad_core.formats.openscenario.test_xosc_roads import piece, xodr
from tests.sgcad_core.formats.xosc_samples import at, entity, event, lane, scenario, speed_action, world

V1 = {"V1": world(0, 0)}
HEADER = '<FileHeader revMajor="1" revMinor="3" date="2020-01-01T00:00:00" description="" author=""/>'
CAR = (
    '<Vehicle name="small" vehicleCategory="car"><ParameterDeclarations>'
    '<ParameterDeclaration name="length" parameterType="double" value="4"/></ParameterDeclarations>'
    '<BoundingBox><Center x="1" y="0" z="0.7"/><Dimensions width="1.8" length="$length" height="1.4"/></BoundingBox>'
    "</Vehicle>"
)
REFERENCE = '<CatalogReference catalogName="cars" entryName="small">{}</CatalogReference>'
LONGER = '<ParameterAssignments><ParameterAssignment parameterRef="length" value="${2 * $n}"/></ParameterAssignments>'


def written(folder, text, name="play.xosc"):
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    return file


def with_catalog(folder, inner="", car=CAR):
    written(folder, f'<OpenSCENARIO>{HEADER}<Catalog name="cars">{car}</Catalog></OpenSCENARIO>', "cat/cars.xosc")
    text = scenario(V1, entities=f'<ScenarioObject name="V1">{REFERENCE.format(inner)}</ScenarioObject>')
    declared = '<ParameterDeclaration name="n" parameterType="double" value="3"/>'
    text = text.replace("<ParameterDeclarations>", f"<ParameterDeclarations>{declared}")
    where = '<CatalogLocations><VehicleCatalog><Directory path="cat"/></VehicleCatalog></CatalogLocations>'
    return written(folder, text.replace("<CatalogLocations/>", where))


def played(file, **more):
    return play_file(variations(file)[0], **more)[0]


@pytest.mark.parametrize(("inner", "length"), [("", 4.0), (LONGER, 6.0)])
def test_entities_come_from_catalogs_with_their_parameters(tmp_path, inner, length):
    assert played(with_catalog(tmp_path, inner)).bodies["V1"].box.length_m == length


def test_a_catalog_entry_that_is_not_there_is_named_with_those_that_are(tmp_path):
    file = with_catalog(tmp_path)
    file.write_text(file.read_text().replace('entryName="small"', 'entryName="large"'))
    with pytest.raises(InvalidOutput, match=r"no such catalog entry .*play.xosc .*cars/large.*cars has: small"):
        played(file)


def test_catalogs_that_refer_to_themselves_end(tmp_path):
    file = with_catalog(tmp_path, car=REFERENCE.format("").replace("Reference ", 'Reference name="small" '))
    with pytest.raises(InvalidOutput, match="the catalog entry must be a Vehicle or Pedestrian or MiscObject"):
        played(file)


def test_a_fault_in_a_catalog_names_the_catalogs_file(tmp_path):
    file = with_catalog(tmp_path, car=CAR.replace('value="4"', 'value="-4"'))
    with pytest.raises(InvalidOutput, match=r"'length' must be above 0 at <Dimensions> in line 1 of cars.xosc"):
        played(file)


# ------------------------------------------------------------------ maps
ROAD = xodr(piece("<line/>", 0, 0, 0, 0, 100), 100)


def test_a_map_is_found_where_the_file_says_or_in_the_given_folder(tmp_path):
    file = written(tmp_path, scenario({"V1": lane("7", -1, 5)}))
    with pytest.raises(InvalidOutput, match=r"the map 'road.xodr' is not there at <LanePosition>"):
        played(file)
    written(tmp_path, ROAD, "maps/road.xodr")
    assert played(file, maps=[tmp_path / "maps"]).trajectories[0].x_m[0] == pytest.approx(5)
    written(tmp_path, ROAD, "road.xodr")
    assert not played(file).notes


def test_without_its_map_a_scenario_of_world_positions_plays_with_a_note(tmp_path):
    notes = played(written(tmp_path, scenario(V1))).notes
    assert "the map 'road.xodr' is not there" in notes[0].what


def test_a_place_beyond_the_road_is_its_end_for_strangers(tmp_path):
    written(tmp_path, ROAD, "road.xodr")
    result = played(written(tmp_path, scenario({"V1": lane("7", -1, 500)})))
    assert result.trajectories[0].x_m[0] == pytest.approx(100)
    assert "s = 500 m lies beyond road '7'" in result.notes[0].what


# ------------------------------------------------------------------ distributions
def distribution(folder, inner):
    text = f'<OpenSCENARIO>{HEADER}<ParameterValueDistribution><ScenarioFile filepath="play.xosc"/>{inner}'
    return written(folder, text + "</ParameterValueDistribution></OpenSCENARIO>", "sets.xosc")


SINGLE = (
    '<DeterministicSingleParameterDistribution parameterName="v"><DistributionRange stepWidth="5">'
    '<Range lowerLimit="10" upperLimit="20"/></DistributionRange></DeterministicSingleParameterDistribution>'
)
SPEED = '<ParameterDeclaration name="v" parameterType="double" value="1"/>'


def test_a_distribution_plays_its_scenario_with_every_set(tmp_path):
    written(tmp_path, scenario(V1, speeds={"V1": "$v"}, parameters=SPEED))
    sets = variations(distribution(tmp_path, f"<Deterministic>{SINGLE}</Deterministic>"))
    assert [s.given for s in sets] == [{"v": "10"}, {"v": "15"}, {"v": "20"}]
    assert [play_file(s)[0].trajectories[0].speed_mps[-1] for s in sets] == [10, 15, 20]


def test_stochastic_sets_are_drawn_by_the_files_own_seed(tmp_path):
    uniform = '<UniformDistribution><Range lowerLimit="3" upperLimit="4"/></UniformDistribution>'
    inner = (
        '<Stochastic numberOfTestRuns="5" randomSeed="7"><StochasticDistribution parameterName="v">'
        f"{uniform}</StochasticDistribution></Stochastic>"
    )
    file = distribution(tmp_path, inner)
    first, second = list(variations(file)), list(variations(file))
    assert first == second
    assert len({s.given["v"] for s in first}) == 5
    assert all(3 <= float(s.given["v"]) <= 4 for s in first)


def test_too_many_sets_are_refused_before_they_are_made(tmp_path):
    axes = "".join(SINGLE.replace('"v"', f'"v{i}"').replace('"20"', '"490"') for i in range(3))
    with pytest.raises(InvalidOutput, match=r"makes at least 912673 parameter sets, at most 10000"):
        variations(distribution(tmp_path, f"<Deterministic>{axes}</Deterministic>"))


# ------------------------------------------------------------------ strangers
STEP = 'dynamicsShape="step" dynamicsDimension="time" value="0"'


@pytest.mark.parametrize(("old", "new", "told"), [
    (STEP, 'dynamicsShape="linear" dynamicsDimension="rate" value="-4"', "a rate has no sign"),
    ('length="4.6"', 'length="0"', "'length' is 0"),
    ("<VisibilityAction/>", "", "needs exactly one child element"),
])  # fmt: skip
def test_what_other_players_let_pass_is_noted_not_refused(tmp_path, old, new, told):
    inner = '<Action name="x"><PrivateAction><VisibilityAction/></PrivateAction></Action>'
    text = scenario(V1, event("e", speed_action(7), at(1)).replace("<Action", inner + "<Action", 1))
    text = (
        text.replace("<PrivateAction><VisibilityAction/></PrivateAction>", "<VisibilityAction/>") if not new else text
    )
    notes = played(written(tmp_path, text.replace(old, new))).notes
    assert any(told in note.what for note in notes)
    assert all(note.severity == "note" and "line" in note.where for note in notes if "map" not in note.what)


def test_controllers_are_noted(tmp_path):
    on = '<ActivateControllerAction longitudinal="true" lateral="true"/>'
    notes = played(written(tmp_path, scenario(V1, event("e", on, at(1))))).notes
    assert any("controllers are the simulator's own" in note.what for note in notes)


def test_a_scenario_without_end_is_cut_with_a_note(tmp_path):
    result = played(written(tmp_path, scenario(V1, end=at(9999))), until_s=2.0)
    assert result.trajectories[0].t_s[-1] == pytest.approx(2.0)
    assert any("does not end by itself" in note.what for note in result.notes)


def test_random_traffic_is_refused_by_its_element(tmp_path):
    swarm = "<GlobalAction><TrafficAction><TrafficSwarmAction/></TrafficAction></GlobalAction>"
    text = scenario(V1).replace("<Private ", f"{swarm}<Private ", 1)
    with pytest.raises(Unsupported, match=r"<TrafficAction> in line 2 of play.xosc -> write each vehicle") as caught:
        played(written(tmp_path, text))
    assert caught.value.element == "TrafficAction"


def test_only_scenario_files_are_read(tmp_path):
    (tmp_path / "secret.txt").write_text("no")
    with pytest.raises(BadInput, match="no such file"):
        play_file(Variation(tmp_path / "secret.txt", {}))
    with pytest.raises(BadInput, match="no such folder"):
        scenario_files(tmp_path / "gone")
    file = with_catalog(tmp_path)
    assert scenario_files(tmp_path) == [file]


def test_an_entity_may_come_and_go(tmp_path):
    def of(name, inner):
        action = f'<EntityAction entityRef="V2">{inner}</EntityAction>'
        return f'<Action name="{name}"><GlobalAction>{action}</GlobalAction></Action>'

    add = event("add", "<X/>", at(1)).replace(
        '<Action name="add_action"><PrivateAction><X/></PrivateAction></Action>',
        of("a", f"<AddEntityAction>{world(5, 0)}</AddEntityAction>"),
    )
    gone = event("gone", "<X/>", at(2)).replace(
        '<Action name="gone_action"><PrivateAction><X/></PrivateAction></Action>', of("b", "<DeleteEntityAction/>")
    )
    result = played(written(tmp_path, scenario(V1, add + gone, entities=entity("V1") + entity("V2"))))
    assert result.presence["V2"] == pytest.approx((1.0, 1.95), abs=0.051)
    assert set(result.trajectories[1].x_m) == {5.0}
