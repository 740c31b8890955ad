"""Recorded dialogues (tests/recorded) through the whole chain, and a prompt that has changed since.

Reports and answers are made up by hand, as a capable model would have led the dialogue; no figure of a model comes of
it.
"""

import pytest
import yaml

from flows.case_files.find_cases import cases_in
from plugins.backbone.scripted import ASKED, Scripted
from research.benchmarks.scenes.recorded import REPORTS, contradictions, recorded_config, row_of
from sgcad_core.case.records import Context, Query
from sgcad_core.errors import ConfigError
from sgcad_core.registry import plugin_class

CASES = {case.id: case for case in cases_in([REPORTS])}
QUICK = (
    "left_across_signal",
    "rear_end_stopped",
    "pedestrian_midblock",
    "pole_right",
    "near_lane_change",
    "wrong_way_leg",
)


def params():
    for name in CASES:
        marks = [] if name in QUICK else [pytest.mark.slow]
        yield pytest.param(name, marks=marks)


@pytest.fixture(scope="module")
def config():
    return recorded_config()


@pytest.mark.parametrize("name", params())
def test_a_recorded_dialogue_becomes_a_scenario_with_all_that_is_told(config, name, tmp_path):
    row = row_of(config, CASES[name], tmp_path)
    assert row.passes, row.line()
    assert list(contradictions(tmp_path / config.name / name)) == []


def test_there_are_41_dialogues_and_each_has_both_stages():
    told = [one for file in sorted((REPORTS.parent / "answers").glob("*.yaml")) if file.name != ASKED
            for one in yaml.safe_load(file.read_text())]  # fmt: skip
    assert len(told) == len(CASES) == 41
    assert {one["case"] for one in told} == set(CASES)
    assert all(one["road"] and one["scenario"] for one in told)
    assert sum(len(one["road"]) + len(one["scenario"]) > 2 for one in told) >= 6


def test_a_changed_prompt_or_schema_is_refused_with_the_remedy(config):
    backbone, greedy = config.backbone, plugin_class("decoder", "greedy")()
    assert isinstance(backbone, Scripted)
    query = Query(task="another prompt", answer_schema={}, case="deer", stage="road")
    with pytest.raises(ConfigError, match=r"'deer', stage road: the prompt or the answer schema has changed.*--keep"):
        backbone.generate(Context(narrative=""), query, greedy)


def test_every_question_of_a_dialogue_is_written_down(config):
    assert {case: sorted(stages) for case, stages in config.backbone.asked.items()} == {
        case: ["road", "scenario"] for case in CASES
    }
