"""One budget of work and memory: what would take too much is refused by element and limit before it is done."""

from __future__ import annotations

import time
import tracemalloc
from itertools import islice
from statistics import mean, variance

import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.playing.player import play_scenario
from sgcad_core.formats.openscenario.reading import budget
from sgcad_core.formats.openscenario.reading.elements import XmlNode, read_root
from sgcad_core.formats.openscenario.reading.file_context import MAX_NOTES, FileContext
from sgcad_core.formats.openscenario.reading.files import play_file, variations
from sgcad_core.formats.openscenario.reading.variation import ParameterSets
from sgcad_core.formats.openscenario.roads.road_links import Leg
from sgcad_core.formats.openscenario.roads.road_network import AHEAD_M, XodrRoads
from sgcad_core.formats.xml import parse_xml
from tests.sgcad_core.formats.openscenario.test_foreign_files import HEADER, V1, distribution, played, written
from tests.sgcad_core.formats.openscenario.test_xosc_roads import piece, xodr
from tests.sgcad_core.formats.xosc_samples import at, event, follow, lane, scenario, world

MOST_S, MOST_B = 10.0, 350e6
"""Of a refusal, on a loaded machine."""
LINE = piece("<line/>", 0, 0, 0, 0, 100)


@pytest.fixture
def cheap():
    """A body that may take neither long nor much memory."""
    tracemalloc.start()
    began = time.process_time()
    yield
    spent, peak = time.process_time() - began, tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert spent < 3 * MOST_S, "tracing makes it slower"
    assert peak < MOST_B


def foreign(text):
    return read_root(text, book=FileContext("file.xosc", strict=False))


# ------------------------------------------------------------------ maps
@pytest.mark.usefixtures("cheap")
@pytest.mark.parametrize(("count", "length"), [(100_000, 20_000), (100_000, 0.1), (300, 20_000)])
def test_a_road_of_too_many_points_is_refused_before_they_are_made(count, length):
    roads = XodrRoads(xodr(piece("<line/>", 0, 0, 0, 0, length) * count, 5_000))
    with pytest.raises(InvalidOutput, match=r"takes more than \d+ (s|MB) to read .*<road> in line 1"):
        roads.lane_pose("7", -1, 5, 0)


@pytest.mark.usefixtures("cheap")
def test_a_map_of_too_many_elements_is_refused_before_it_is_parsed():
    with pytest.raises(InvalidOutput, match=r"takes more than 5 s to read \(\d+ elements\) at xodr .*<crossing>"):
        XodrRoads(xodr(LINE, 100).replace("<lanes>", "<crossing/>" * 1_000_000 + "<lanes>")).road("7")


def chain(count):
    """Roads of 2 m in a row."""
    roads = []
    for k in range(count):
        before = f'<predecessor elementType="road" elementId="{k - 1}" contactPoint="end"/>' if k else ""
        behind = f'<successor elementType="road" elementId="{k + 1}" contactPoint="start"/>' if k < count - 1 else ""
        road = xodr(piece("<line/>", 0, 2 * k, 0, 0, 2), 2).removeprefix("<OpenDRIVE>").removesuffix("</OpenDRIVE>")
        roads.append(
            road.replace('id="7"', f'id="{k}"').replace("<planView>", f"<link>{before}{behind}</link><planView>")
        )
    return f"<OpenDRIVE>{''.join(roads)}</OpenDRIVE>"


@pytest.mark.usefixtures("cheap")
def test_a_way_over_thousands_of_roads_is_found():
    roads = XodrRoads(chain(3_000))
    found = roads.apart(roads.place_at("0", 1.0, -1.0), 1, roads.place_at("2999", 1.0, -1.0))
    assert found is not None
    assert found.ahead_m == pytest.approx(2 * 2999)


@pytest.mark.usefixtures("cheap")
def test_thirty_thousand_linked_roads_are_refused():
    with pytest.raises(InvalidOutput, match="takes more than"):
        XodrRoads(chain(30_000)).road("0")


def test_a_way_is_searched_once(monkeypatch):
    roads = XodrRoads(chain(50))
    first, last = roads.place_at("0", 1.0, -1.0), roads.place_at("49", 1.0, -1.0)
    roads.apart(first, 1, last)
    spent = dict(roads.budget.counts)
    assert roads.apart(first._replace(s_m=0.5), 1, last).ahead_m == pytest.approx(2 * 49 + 0.5)
    assert roads.budget.counts["roads on a way"] == spent["roads on a way"]


def test_a_ring_leads_back_to_its_first_road():
    ends = '<predecessor elementType="road" elementId="7" contactPoint="end"/>'
    ends += '<successor elementType="road" elementId="7" contactPoint="start"/>'
    roads = XodrRoads(xodr(LINE, 100).replace("<planView>", f"<link>{ends}</link><planView>"))
    roads.road("7")
    assert roads._links.path(Leg("7", 1), 60.0, {Leg("7", 1): 20.0}) == ([Leg("7", 1), Leg("7", 1)], 80.0)


def test_the_center_line_of_a_road_ends_with_it():
    roads = XodrRoads(chain(3))
    assert roads.drive(roads.place_at("0", 0.5, -1.0)._replace(lane=0, offset_m=0.0), 1).dead_end


def test_a_long_road_is_driven_in_pieces():
    roads = XodrRoads(xodr(piece("<line/>", 0, 0, 0, 0, 9_000), 9_000))
    way = roads.drive(roads.place_at("7", 10.0, -1.0), 1)
    assert not way.dead_end
    assert way.points[-1][0] - way.points[0][0] == pytest.approx(AHEAD_M, abs=1.0)


def test_widths_count_from_where_they_begin_in_whatever_order_they_stand():
    second = '<width sOffset="20" a="6" b="0" c="0" d="0"/>'
    first = '<width sOffset="0" a="4" b="0" c="0" d="0"/>'
    for both in (first + second, second + first):
        roads = XodrRoads(xodr(LINE, 100).replace(first, both))
        assert [roads.road("7").width_m(-1, s) for s in (10.0, 20.0, 30.0)] == [4, 6, 6]


# ------------------------------------------------------------------ parameters and distributions
def stochastic(inner, runs=10_000, count=1):
    each = "".join(
        f'<StochasticDistribution parameterName="p{k}">{inner}</StochasticDistribution>' for k in range(count)
    )
    return f'<Stochastic numberOfTestRuns="{runs}" randomSeed="3">{each}</Stochastic>'


def sets_of(inner):
    text = f'<OpenSCENARIO>{HEADER}<ParameterValueDistribution><ScenarioFile filepath="x"/>{inner}'
    return read_root(text + "</ParameterValueDistribution></OpenSCENARIO>")


UNIFORM = '<UniformDistribution><Range lowerLimit="0" upperLimit="1"/></UniformDistribution>'


def test_only_the_sets_that_are_wanted_are_drawn(tmp_path):
    root = sets_of(stochastic(UNIFORM, count=100))
    sets = ParameterSets(root)
    assert len(sets) == 10_000
    assert len(list(islice(sets, 3))) == 3
    assert root.book.budget.counts["drawn values"] == 300
    written(tmp_path, scenario(V1))
    found = variations(distribution(tmp_path, stochastic(UNIFORM)))
    assert (found[2], found[:2]) == (list(found)[2], list(found)[:2])


@pytest.mark.usefixtures("cheap")
def test_fifty_thousand_parameters_are_refused():
    with pytest.raises(InvalidOutput, match=r"varies more than 5000 parameters at <Stochastic>"):
        ParameterSets(sets_of(stochastic(UNIFORM, count=50_000)))


@pytest.mark.slow
@pytest.mark.usefixtures("cheap")
def test_ranges_of_many_parameters_take_no_memory():
    wide = (
        '<DeterministicSingleParameterDistribution parameterName="p{}"><DistributionRange stepWidth="1"><Range '
        'lowerLimit="1" upperLimit="10000"/></DistributionRange></DeterministicSingleParameterDistribution>'
    )
    many = "".join(wide.format(k) for k in range(5_000))
    with pytest.raises(InvalidOutput, match="listed values"):
        ParameterSets(sets_of(f"<Deterministic>{many}</Deterministic>"))


@pytest.mark.parametrize("expected", [3, 29, 31, 200, 1e4, 1e6])
def test_a_poisson_number_has_its_mean_and_variance(expected):
    inner = f'<PoissonDistribution expectedValue="{expected:.0f}"/>'
    began = time.process_time()
    drawn = [float(s["p0"]) for s in islice(ParameterSets(sets_of(stochastic(inner))), 4_000)]
    assert time.process_time() - began < 2.0
    assert mean(drawn) == pytest.approx(expected, abs=5 * (expected / 4_000) ** 0.5)
    assert variance(drawn) == pytest.approx(expected, rel=0.15)


def test_a_log_normal_number_beyond_all_numbers_is_cut_to_its_range():
    inner = '<LogNormalDistribution expectedValue="1000000" variance="1"><Range lowerLimit="0" upperLimit="9"/>'
    assert next(iter(ParameterSets(sets_of(stochastic(f"{inner}</LogNormalDistribution>")))))["p0"] == "9"
    bare = '<LogNormalDistribution expectedValue="1000000" variance="1"/>'
    assert next(iter(ParameterSets(sets_of(stochastic(bare)))))["p0"] == "1000000000"


@pytest.mark.usefixtures("cheap")
def test_scopes_do_not_copy_what_is_declared_outside():
    declared = "".join(f'<ParameterDeclaration name="p{k}" parameterType="string" value="{k}"/>' for k in range(4_000))
    own = '<ParameterDeclarations><ParameterDeclaration name="q" value="1"/></ParameterDeclarations>'
    root = read_root(scenario(V1, parameters=declared))
    inner = XmlNode(parse_xml(f"<Maneuver>{own}</Maneuver>", "x"), root.scope, root.book)
    scopes = [inner.scoped().scope for _ in range(2_000)]
    assert (scopes[-1]["q"], scopes[-1]["p7"]) == ("1", "7")


# ------------------------------------------------------------------ catalogs
def waypoint(entry, count):
    ref = f'<CatalogReference catalogName="c" entryName="{entry}"/>'
    place = '<InRoutePosition><FromRoadCoordinates pathS="1" t="0"/></InRoutePosition>'
    route = f"<Position><RoutePosition><RouteRef>{ref}</RouteRef>{place}</RoutePosition></Position>"
    return f'<Waypoint routeStrategy="shortest">{route}</Waypoint>' * count


@pytest.mark.slow
@pytest.mark.usefixtures("cheap")
def test_catalogs_that_branch_end(tmp_path):
    entries = "".join(f'<Route name="r{k}" closed="false">{waypoint(f"r{k + 1}", 8)}</Route>' for k in range(9))
    last = f'<Route name="r9" closed="false"><Waypoint routeStrategy="shortest">{lane("7", -1, 5)}</Waypoint></Route>'
    text = f'<OpenSCENARIO>{HEADER}<Catalog name="c">{entries}{last}</Catalog></OpenSCENARIO>'
    written(tmp_path, text, "cat/routes.xosc")
    where = '<CatalogLocations><RouteCatalog><Directory path="cat"/></RouteCatalog></CatalogLocations>'
    start = waypoint("r0", 1).removeprefix('<Waypoint routeStrategy="shortest">').removesuffix("</Waypoint>")
    file = written(tmp_path, scenario({"V1": start}).replace("<CatalogLocations/>", where))
    with pytest.raises(
        InvalidOutput, match=r"elements of catalog entries.*<CatalogReference> in line 1 of routes.xosc"
    ):
        played(file)


def test_a_folder_that_is_named_many_times_is_read_once(tmp_path):
    text = f'<OpenSCENARIO>{HEADER}<Catalog name="c"/></OpenSCENARIO>'
    for k in range(5):
        written(tmp_path, text, f"cat/{k}.xosc")
    where = '<RouteCatalog><Directory path="cat"/></RouteCatalog>' * 2_000
    ref = '<ScenarioObject name="V1"><CatalogReference catalogName="c" entryName="x"/></ScenarioObject>'
    text = scenario(V1, entities=ref).replace("<CatalogLocations/>", f"<CatalogLocations>{where}</CatalogLocations>")
    began = time.process_time()
    with pytest.raises(InvalidOutput, match="no such catalog entry"):
        played(written(tmp_path, text))
    assert time.process_time() - began < MOST_S


# ------------------------------------------------------------------ playing
def test_what_takes_too_long_to_play_is_refused(monkeypatch):
    monkeypatch.setattr(budget, "PLAYED_S", 1.0)
    many = "".join(event(f"e{i}", "<VisibilityAction/>", at(99), "parallel") for i in range(2_000))
    with pytest.raises(InvalidOutput, match=r"takes more than 1 s to play .*tests of conditions.*<Storyboard>"):
        play_scenario(foreign(scenario({"V1": world(0, 0)}, many, end=at(290))), None)


def test_a_trajectory_that_is_begun_again_and_again_is_refused(monkeypatch):
    monkeypatch.setattr(budget, "PLAYED_S", 1.0)
    path = [(k / 1_000, k / 100, 0, None) for k in range(2_000)]
    timed = '<Timing domainAbsoluteRelative="relative" scale="0.001" offset="0"/>'
    again = event("e", follow(path, timed), at(0), "override", 5_000)
    with pytest.raises(InvalidOutput, match=r"takes more than 1 s to play"):
        play_scenario(foreign(scenario({"V1": world(0, 0)}, again, end=at(290))), None)


@pytest.mark.usefixtures("cheap")
def test_a_piece_of_a_billion_seconds_takes_no_memory():
    path = follow(
        [(0, 0, 0, None), (1e9, 50, 0, None)], '<Timing domainAbsoluteRelative="absolute" scale="1" offset="0"/>'
    )
    eased = path.replace('followingMode="position"', 'followingMode="follow"')
    found = play_scenario(foreign(scenario({"V1": world(0, 0)}, event("e", eased, at(0)), end=at(3))), None)
    assert len(found.trajectories[0].t_s) == 61


def test_a_box_longer_than_any_ship_is_refused():
    with pytest.raises(InvalidOutput, match=r"'length' must be at most 500 m at <Dimensions>"):
        play_scenario(foreign(scenario({"V1": world(0, 0)}).replace('length="4.6"', 'length="1e6"')), None)


# ------------------------------------------------------------------ notes
def notes_of(text):
    return play_scenario(foreign(text), None).notes


def test_an_edge_that_cannot_come_is_noted_with_the_reason():
    (note,) = notes_of(scenario(V1, event("e", "<VisibilityAction/>", at(0, edge="rising"))))
    assert "rising edge of this condition never comes" in note.what
    assert "it holds already at 0 s" in note.value
    assert "<Condition" in note.where
    assert not notes_of(scenario(V1, event("e", "<VisibilityAction/>", at(1, edge="rising"))))
    assert not notes_of(scenario(V1, event("e", "<VisibilityAction/>", at(99, edge="rising"))))


def test_a_declared_name_loses_its_dollar_with_a_note(tmp_path):
    declared = '<ParameterDeclaration name="$v" parameterType="double" value="5"/>'
    result = played(written(tmp_path, scenario(V1, speeds={"V1": "$v"}, parameters=declared)))
    assert result.trajectories[0].speed_mps[-1] == 5
    assert any("begins with $" in note.what and note.value == "$v" for note in result.notes)


def test_a_trajectory_that_begins_elsewhere_is_noted_as_a_jump():
    path = follow([(None, 50, 0, None), (None, 90, 0, None)])
    (note,) = notes_of(scenario(V1, event("e", path, at(1)), {"V1": 5}))
    assert "jumps" in note.what
    assert note.value == "V1: 45.0 m"
    near = follow([(None, 5.2, 0, None), (None, 90, 0, None)])
    assert not notes_of(scenario(V1, event("e", near, at(1)), {"V1": 5}))


def test_very_many_notes_are_cut():
    command = '<UserDefinedAction><CustomCommandAction type="x"/></UserDefinedAction>'
    one = event("e", "<VisibilityAction/>", at(99), "parallel").replace(
        "<PrivateAction><VisibilityAction/></PrivateAction>", command
    )
    text = scenario(V1, "".join(one.replace('"e"', f'"e{k}"') + "\n" for k in range(MAX_NOTES + 50)))
    notes = notes_of(text)
    assert len(notes) == MAX_NOTES + 1
    assert notes[-1].what == "more notes are left out"


# ------------------------------------------------------------------ odd names of files
@pytest.mark.parametrize("named", ["x" * 5_000, "a/" * 2_000, "\\\\host\\x.xodr", "%00.xodr", "/dev/zero", "."])
def test_an_odd_name_of_a_map_is_a_map_that_is_not_there(tmp_path, named):
    text = scenario(V1).replace("road.xodr", named)
    assert f'filepath="{named}"' in text
    notes = play_file(variations(written(tmp_path, text))[0], [tmp_path])[0].notes
    assert any("is not there" in note.what and len(note.what) < 400 for note in notes)
