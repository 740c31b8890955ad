"""A study is read as its folder tells it: unfinished is not there, and what is wrong is named."""

from pathlib import Path

import pytest

from flows.results.levels import base_of, level_of
from flows.results.reading import find_study, load_study, made_of, paths_of
from sgcad_core.errors import ConfigError


def test_only_finished_cases_are_there(study):
    folder = study({"a": {"c1": {}, "c2": {"status": "refused"}}, "b": {"c1": {}}}, cases=["c1", "c2", "c3"])
    read = load_study(folder)
    assert {arm: list(cases) for arm, cases in read.ran.items()} == {"a": ["c1", "c2"], "b": ["c1"]}
    assert read.progress() == (3, 6)
    assert set(read.labels) == {"c1", "c2", "c3"}


def test_a_result_being_written_is_not_finished(study):
    folder = study({"a": {"c1": {}, "c2": {}}})
    (folder / "a" / "c2" / "result.json").write_text('{"case": "c2", "sta')
    assert list(load_study(folder).ran["a"]) == ["c1"]


def test_ordinary_runs_read_as_a_study(study):
    folder = study({"a": {"c1": {}}, "b": {"c1": {}, "c2": {}}})
    (folder / "study.json").unlink()
    read = load_study(find_study(folder))
    assert [a.name for a in read.arms] == ["a", "b"]
    assert read.cases == ("c1", "c2")
    assert not read.labels


def test_a_name_means_the_study_in_the_results(study, tmp_path):
    folder = study({"a": {"c1": {}}})
    assert find_study(Path("kit"), tmp_path / "runs") == folder
    with pytest.raises(ConfigError, match=r"nothing: no study and no folder of runs; .*: kit"):
        find_study(Path("nothing"), tmp_path / "runs")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("{", "cannot be read"),
        ('{"study": "x"}', "arms, cases, title missing"),
        ("[]", "arms, cases, study, title missing"),
    ],
)
def test_a_broken_study_is_named_with_the_remedy(study, content, told):
    folder = study({"a": {"c1": {}}})
    (folder / "study.json").write_text(content)
    with pytest.raises(ConfigError, match=f"study.json: {told}.*sgcad study"):
        load_study(folder)


def test_a_reference_that_is_no_arm_is_told(study):
    with pytest.raises(ConfigError, match="reference 'z' is no arm; arms: \\['a'\\]"):
        load_study(study({"a": {"c1": {}}}, about={"reference": "z"}))


def test_cases_can_be_chosen_by_the_beginning_of_their_name(study):
    folder = study({"a": {"x-1": {}, "y-1": {}}})
    assert load_study(folder, only="x").cases == ("x-1",)
    with pytest.raises(ConfigError, match="no case begins with 'z'; it has x-1, y-1"):
        load_study(folder, only="z")


def test_truth_given_by_hand_must_be_there_and_hold_labels(study, tmp_path):
    folder = study({"a": {"c1": {}}})
    with pytest.raises(ConfigError, match=r"--truth .*/no: no such folder"):
        load_study(folder, truth=tmp_path / "no")
    (tmp_path / "truth" / "c1.json").write_text("[1]")
    with pytest.raises(ConfigError, match=r"c1.json: no label"):
        load_study(folder)


@pytest.mark.parametrize("spoil", ["road.net.xml", "trajectories.csv"])
def test_an_unreadable_run_counts_as_none(study, spoil):
    folder = study({"a": {"c1": {}}})
    ran = load_study(folder).ran["a"]["c1"]
    assert made_of(ran.folder, ran.result).roads.figures.intersections == 1
    (ran.folder / spoil).write_text("t_s,actor,x_m\nnot,a,number\n")
    assert made_of(ran.folder, ran.result) is None


def test_motion_is_read_in_order_of_time_with_sizes(study):
    ran = load_study(study({"a": {"c1": {}}})).ran["a"]["c1"]
    paths = paths_of(ran.folder, ran.result)
    assert set(paths) == {"V1", "V2"}
    assert paths["V1"].size == (4.6, 1.8)
    assert paths["V1"].pose[[0, -1], 0].tolist() == [-20.0, 9.5]


def test_a_level_is_found_in_factors_or_overrides():
    key = "report_reader.robustness_level"
    assert level_of({key: "blur_weak"}, ()) == "blur_weak"
    assert level_of({}, (f"{key}=total_sparsity",)) == "total_sparsity"
    assert level_of({}, ("seed=1",)) is None
    assert base_of("m.yaml", {key: "full", "seed": 1}, ()) == base_of("m.yaml", {"seed": 1}, (f"{key}=blur_weak",))
