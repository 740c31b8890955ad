"""What the scenario check finds, and that it names place, value and remedy."""

from __future__ import annotations

import re

import numpy as np
import pytest

from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.openscenario.check import MAX_FINDINGS, xosc_findings
from sgcad_core.formats.openscenario.writing.entities import center_ahead_m
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from tests.sgcad_core.formats.xosc_samples import (
    CROSSING,
    actor,
    at,
    condition,
    crossroads,
    event,
    follow,
    lane,
    scenario,
    speed_action,
    timing,
    trajectory,
    world,
)

K = np.arange(40)
REAR_M = round(-60 - center_ahead_m(actor("V1")), 6)
WRITTEN = write_xosc(
    [actor("V1"), actor("P1", "pedestrian", (0.5, 0.6))],
    [trajectory("V1", K * 0.5 - 60, -1.8), trajectory("P1", 10 + 0 * K, K * 0.07, 1.57)],
    CROSSING,
)


def found(text, xodr=None):
    return [f.line() for f in xosc_findings(text, xodr or crossroads().xodr)]


def test_a_written_scenario_passes():
    assert found(WRITTEN) == []


@pytest.mark.parametrize("position", [world(0, 0), lane("{road}", -1, 5)])
def test_a_scenario_by_hand_passes(position):
    road = lane_index(crossroads().xodr).by_edge("W").id
    text = scenario({"V1": position.replace("{road}", road)}, event("e", speed_action(9), at(1)))
    assert found(text) == []


@pytest.mark.parametrize(("minor", "passes"), [("0", False), ("1", False), ("2", True), ("3", True), ("9", False)])
def test_the_declared_version_decides_which_schema_counts(minor, passes):
    text = WRITTEN.replace('revMinor="2"', f'revMinor="{minor}"')
    text = re.sub(r"<EnvironmentAction>.*?</EnvironmentAction>", "<EnvironmentAction/>", text, flags=re.S)
    text = re.sub(r"<GlobalAction>\s*<EnvironmentAction/>\s*</GlobalAction>", "", text)
    assert (found(text) == []) == passes


FAULTS = [
    ('length="4.7"', 'length="-4.7"', "box length must be above 0 .*found -4.7"),
    ('width="1.8"', 'width="90"', "box width must be above 0 and at most 40 m .*found 90"),
    ('entityRef="V1"', 'entityRef="V9"', "no such entity .*found V9.*one of P1, V1"),
    ("road.xodr", "other.xodr", "another road network .*found other.xodr.*write 'road.xodr'"),
    ('name="P1"', 'name="V1"', "2 scenario objects have one name .*found V1"),
    ('name="P1_group"', 'name="V1_group"', "2 <ManeuverGroup> here have one name at <Act name='act'>"),
    ('time="0.05"', 'time="0.15"', "vertex times do not rise .*order the vertices"),
    (f'x="{REAR_M}"', 'x="-160.0"', "the actor jumps .*found [0-9]{4} m/s.*stay below 90"),
    (
        'positionX="0.0"',
        'positionX="-1.4"',
        "center of its rear axle.*must be 0.*found -1.4.*BoundingBox",
    ),
    ("<Story ", "<Storey ", "no well-formed XML"),
    ('revMajor="1"', 'revMajor="2"', "unknown OpenSCENARIO version .*found 2.2"),
    ('vehicleCategory="car"', 'vehicleCategory="spaceship"', "spaceship.*follow the OpenSCENARIO schema"),
    ('conditionEdge="none"', 'conditionEdge="sharp"', "conditionEdge.*in|at line"),
    ('maximumExecutionCount="1"', 'maximumExecutionCount="1.5"', "maximumExecutionCount"),
]


@pytest.mark.parametrize(("old", "new", "message"), FAULTS)
def test_a_fault_is_found_and_named(old, new, message):
    lines = found(WRITTEN.replace(old, new))
    assert lines
    assert len(lines) <= MAX_FINDINGS
    assert any(re.search(message, line) for line in lines), lines


def test_every_finding_says_where_and_what_to_do():
    for old, new, _ in FAULTS:
        for finding in xosc_findings(WRITTEN.replace(old, new), crossroads().xodr):
            assert finding.severity == "repair"
            assert finding.where, finding
            assert finding.remedy, finding


@pytest.mark.parametrize(("position", "message"), [
    (world(9000, 0), "far outside .* at <TeleportAction> in line 2 .*found x = 9000, y = 0.*x -120 to 120"),
    (lane("99", -1, 5), "road '99' is not in the .xodr"),
    (lane("{road}", -9, 5), "lane -9 is not on road"),
    (lane("{road}", -1, 5000), "s = 5000 m is beyond road"),
    ('<Position><RoadPosition roadId="{road}" s="-9" t="0"/></Position>', "s = -9 m is beyond road"),
])  # fmt: skip
def test_places_must_exist(position, message):
    road = lane_index(crossroads().xodr).by_edge("W").id
    lines = found(scenario({"V1": position.replace("{road}", road)}))
    assert any(re.search(message, line) for line in lines), lines


def test_places_behind_a_parameter_are_resolved():
    declared = '<ParameterDeclaration name="far" parameterType="double" value="5000"/>'
    assert "far outside" in found(scenario({"V1": world("$far", 0)}, parameters=declared))[0]


def test_what_only_playing_shows_is_found():
    missing = condition(
        '<ByValueCondition><StoryboardElementStateCondition storyboardElementType="event" '
        'storyboardElementRef="gone" state="completeState"/></ByValueCondition>'
    )
    assert "no storyboard element" in found(scenario({"V1": world(0, 0)}, event("e", speed_action(3), missing)))[0]


def test_a_jump_inside_an_untimed_line_is_no_fault():
    line = follow([(None, 0, 0, None), (None, 90, 0, None)])
    assert found(scenario({"V1": world(0, 0)}, event("e", line, at(0)))) == []


def test_many_faults_are_cut_to_the_worst():
    text = re.sub(r'time="', 'time="9', WRITTEN)
    rows = [(i % 2, 0, 0, 0) for i in range(400)]
    crowd = "".join(event(f"e{i}", follow(rows, timing()), at(0)) for i in range(30))
    assert len(found(scenario({"V1": world(0, 0)}, crowd))) == MAX_FINDINGS
    assert len(found(text)) <= MAX_FINDINGS


@pytest.mark.parametrize("text", ["", "<OpenSCENARIO/>", "<!DOCTYPE a><OpenSCENARIO/>", "<net/>", "{}", "\x00\x01"])
def test_rubbish_is_one_finding_and_no_crash(text):
    assert len(xosc_findings(text, None)) == 1
