"""A study laid out: arms, jobs, study.json; everything wrong is told before anything starts."""

import json

import pytest
import yaml

from flows.case_files.find_cases import dataset_digest
from flows.study.plan import plan
from flows.study_file.spec import load_study
from sgcad_core.errors import ConfigError


@pytest.fixture
def study(tmp_path):
    """A study file with these arms."""

    def write(arms=(), **others):
        file = tmp_path / "kits.yaml"
        file.write_text(yaml.safe_dump({"title": "Kits", "arms": list(arms), **others}))
        return load_study(file)

    return write


def arm(name, config="kit.yaml", **others):
    return {"name": name, "config": config, **others}


def test_arms_are_configs_of_their_own_name(study, config_file, reports, tmp_path):
    config_file()
    made = plan(study([arm("one"), arm("two", set=["seed=7"])]), tmp_path / "out", cases=[reports(a="x", b="y")])
    assert [job.name for job in made.jobs] == ["one/a", "one/b", "two/a", "two/b"]
    assert [config.seed for config in made.batch.configs] == [42, 7]
    assert made.jobs[0].folder.path == tmp_path / "out" / "studies" / "kits" / "one" / "a"
    assert len({job.digest for job in made.jobs}) == 4


def test_the_tracker_learns_the_study(study, config_file, reports, tmp_path):
    config_file(tracker={"name": "mlflow", "artifacts": False})
    config_file("own", tracker={"name": "mlflow", "database": str(tmp_path / "own.db")})
    made = plan(study([arm("one"), arm("two", "own.yaml")]), tmp_path / "out", cases=[reports(a="")])
    one, two = (config.tracker for config in made.batch.configs)
    assert one.experiment == two.experiment == "study/kits"
    assert one.database == tmp_path / "out" / "mlflow.db"
    assert two.database == tmp_path / "own.db"


def test_overrides_of_all_arms_come_before_an_arms_own(study, config_file, reports, tmp_path):
    config_file()
    arms = [arm("one"), arm("two", set=["seed=7"])]
    made = plan(study(arms), tmp_path / "out", cases=[reports(a="")], overrides=["seed=5", "max_attempts=3"])
    assert [(c.seed, c.max_attempts) for c in made.batch.configs] == [(5, 3), (7, 3)]


def test_every_fault_is_told_at_once_and_nothing_is_made(study, config_file, tmp_path):
    config_file()
    arms = [
        arm("one", set=["road_writer.lanes=2"]), arm("one"), arm("two", "nothing.yaml"),
        arm("three", set=["simulator=nothing"]), arm("four", published="nobody"), arm("five", oops=1),
        arm("six", set=["decoder=cad", "backbone={name: openai_chat, model: m}"]),
    ]  # fmt: skip
    with pytest.raises(ConfigError) as told:
        plan(study(arms, reference="none", truth="nowhere"), tmp_path / "out", jobs=0)
    text = str(told.value)
    for fault in (
        "road_writer.lanes: unknown field", "arm 'one' stands twice", "nothing.yaml: no such config.",
        "unknown simulator 'nothing'", "published 'nobody' is no row", "arms.5.oops: unknown key",
        "decoder 'cad' needs logits", "no arm is called 'none'", "no cases: give --cases DIR",
        "truth nowhere: no such folder", "--jobs 0",
    ):  # fmt: skip
        assert fault in text
    assert not (tmp_path / "out").exists()


def test_the_document_says_what_a_reader_needs(study, config_file, reports, tmp_path):
    config_file()
    arms = [arm("one", label="One", published="tbg"), arm("two", factors={"seed": 7}, set=["seed=7"])]
    made = plan(study(arms, reference="one"), tmp_path / "out", cases=[reports(a="", b="")], truth=tmp_path)
    document = json.loads(made.write().read_text())
    assert made.write() == tmp_path / "out" / "studies" / "kits" / "study.json"
    assert set(document) == {
        "study", "title", "reference", "truth", "cases", "dataset_digest", "arms", "package", "git_commit", "hardware",
        "again",
    }  # fmt: skip
    assert document["cases"] == ["a", "b"]
    assert document["truth"] == str(tmp_path)
    assert document["again"]["cases"] == [str(tmp_path / "cases")]
    one, two = document["arms"]
    assert (one["label"], one["published"], one["factors"]) == ("One", "tbg", {})
    assert (two["label"], two["set"], two["factors"]) == ("two", ["seed=7"], {"seed": 7})
    assert one["digest"] != two["digest"]
    assert document["hardware"]["cores"] >= 1


def test_a_data_set_is_its_content(study, config_file, reports):
    from flows.case_files.find_cases import cases_in

    found = cases_in([reports(a="", b="x")])
    before = dataset_digest(found)
    assert dataset_digest(reversed(found)) == before
    (found[0].source / "report.txt").write_text("another text")
    assert dataset_digest(found) != before


def test_the_command_lines_cases_win(study, config_file, reports, tmp_path):
    config_file()
    elsewhere = tmp_path / "elsewhere" / "z"
    elsewhere.mkdir(parents=True)
    (elsewhere / "report.txt").write_text("text")
    own = study([arm("one")], cases=[str(reports(a=""))])
    assert [job.name for job in plan(own, tmp_path / "out").jobs] == ["one/a"]
    assert [job.name for job in plan(own, tmp_path / "out", cases=[elsewhere.parent]).jobs] == ["one/z"]


def test_jobs_are_found_by_name_in_the_studys_order(study, config_file, reports, tmp_path):
    config_file()
    made = plan(study([arm("one"), arm("two")]), tmp_path / "out", cases=[reports(a="", b="")])
    assert [job.name for job in made.jobs_named(["two/a", "one/b"])] == ["one/b", "two/a"]
    with pytest.raises(ConfigError, match="no such job: two/c"):
        made.jobs_named(["two/c"])
