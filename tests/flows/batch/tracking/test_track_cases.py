"""Trackers are told before the first case of a config and after the last, whatever became of the batch before."""

from pathlib import Path

import pytest

from flows.batch.plan_batch import Job
from flows.batch.tracking import track_cases
from flows.case.run_case import Ending
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from sgcad_core.config import load
from sgcad_core.errors import MissingTool
from sgcad_core.interfaces import Tracker

RESULT = {"status": "generated", "seconds": {}}


class Noting(Tracker):
    """Notes what it is told in a file; raises at the end where told to."""

    file: Path
    fails: bool = False

    def _note(self, text):
        with self.file.open("a") as out:
            out.write(text + "\n")

    def begin(self, arm):
        self._note(f"begin {arm.config} {arm.dataset.cases}")

    def log_case(self, config_name, params, case_dir, result):
        self._note(f"case {case_dir.name}")

    def identity(self, out):
        return str(self.file.parent.joinpath("place").exists())

    def end(self, arm, finished):
        if self.fails:
            raise OSError("the database is locked")
        self._note(f"end {arm.config} {finished}{arm.fault and f' {arm.fault}'}")


@pytest.fixture
def told(tmp_path):
    """What the tracker was told since the last look."""
    file = tmp_path / "told.txt"

    def look():
        lines = file.read_text().splitlines() if file.exists() else []
        file.write_text("")
        return lines

    return look


@pytest.fixture
def plan(tmp_path, reports, config_file):
    """Two jobs of one config."""
    folder = reports(c1="", c2="")
    config = load(config_file()).model_copy(update={"tracker": Noting(file=tmp_path / "told.txt")})
    jobs = [
        Job(config, Case(folder / name, name), "digest", CaseFolder(tmp_path / "out", "kit", name))
        for name in ("c1", "c2")
    ]
    for job in jobs:
        job.folder.path.mkdir(parents=True)
    return jobs


def test_begin_and_end_enclose_the_cases_and_a_second_batch_tells_nothing(plan, told):
    with track_cases.tracked_batch(plan):
        for job in plan:
            track_cases.track(job, Ending(RESULT))
    assert told() == ["begin kit 2", "case c1", "case c2", "end kit True"]
    assert all(track_cases.tracked(job) for job in plan)
    with track_cases.tracked_batch(plan):
        track_cases.track(plan[0], Ending(RESULT))
    assert told() == []


def test_cases_are_logged_again_where_the_place_of_the_log_was_made_anew(plan, told, tmp_path):
    with track_cases.tracked_batch(plan):
        for job in plan:
            track_cases.track(job, Ending(RESULT))
    told()
    (tmp_path / "place").touch()
    assert not any(track_cases.tracked(job) for job in plan)
    with track_cases.tracked_batch(plan):
        for job in plan:
            track_cases.track(job, Ending(RESULT))
    assert told() == ["begin kit 2", "case c1", "case c2", "end kit True"]


def test_a_batch_that_is_interrupted_says_so_and_the_next_one_ends_it(plan, told):
    def interrupted():
        with track_cases.tracked_batch(plan):
            track_cases.track(plan[0], Ending(RESULT))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert told() == ["begin kit 2", "case c1", "end kit False"]
    with track_cases.tracked_batch(plan):
        for job in plan:
            track_cases.track(job, Ending(RESULT))
    assert told() == ["begin kit 2", "case c2", "end kit True"]


def test_a_batch_that_a_fault_ends_says_which(plan, told):
    def broken():
        with track_cases.tracked_batch(plan):
            raise MissingTool("netconvert is not installed: pip install eclipse-sumo")

    with pytest.raises(MissingTool, match="netconvert"):
        broken()
    assert told()[-1] == "end kit False MissingTool: netconvert is not installed: pip install eclipse-sumo"


def test_a_batch_killed_after_its_last_case_is_ended_by_the_next(plan, told):
    killed = track_cases.tracked_batch(plan)  # never left, as kill -9 leaves it
    killed.__enter__()
    for job in plan:
        track_cases.track(job, Ending(RESULT))
    assert not any(track_cases.tracked(job) for job in plan)
    told()
    with track_cases.tracked_batch(plan):
        pass
    assert told() == ["begin kit 2", "end kit True"]
    assert all(track_cases.tracked(job) for job in plan)


def test_a_tracker_that_cannot_be_told_ends_no_batch_and_is_told_again(plan, told, caplog):
    for job in plan:
        track_cases.track(job, Ending(RESULT))
    broken = plan[0].config.tracker.model_copy(update={"fails": True})
    jobs = [Job(j.config.model_copy(update={"tracker": broken}), j.case, j.digest, j.folder) for j in plan]
    with track_cases.tracked_batch(jobs):
        pass
    assert (
        "keeps the tracker's database locked: end it (`fuser FILE` names it); then run the same command again"
        in caplog.text
    )
    assert not any(track_cases.tracked(job) for job in jobs)


def test_parameters_hold_every_default_and_no_tracker(config_file):
    params = track_cases.params_of(load(config_file()))
    assert params["report_reader"]["name"] == "auto"
    assert params["report_reader"]["robustness_level"] == "full"
    assert params["max_attempts"] == 10
    assert params["validators"] == [{"name": "testkit"}]
    assert "tracker" not in params


def test_a_data_set_is_known_by_its_reports_in_any_order(plan):
    first, second = (job.case for job in plan)
    found = track_cases.dataset_of((first, second))
    assert found.digest == track_cases.dataset_of((second, first)).digest
    assert found.digest != track_cases.dataset_of((first,)).digest
    assert (found.name, found.cases) == ("cases", 2)


def test_a_database_that_stays_locked_is_tried_twice_and_told_in_one_line(config_file, reports, tmp_path):
    from types import SimpleNamespace

    tried = []

    class Locked(Noting):
        def log_case(self, config_name, params, case_dir, result):
            tried.append(case_dir.name)
            raise RuntimeError(
                "raised as a result of autoflush\n(sqlite3.OperationalError) database is locked\n[SQL: ...]"
            )

    config = load(config_file()).model_copy(update={"tracker": Locked(file=tmp_path / "told.txt")})
    folder = SimpleNamespace(path=tmp_path / "kit" / "a", out=tmp_path, tracked=lambda mark: False)
    job = SimpleNamespace(config=config, folder=folder, case=SimpleNamespace(id="a"))
    track_cases._failed.clear()
    said = [track_cases.track_safely(job, SimpleNamespace(result={})) for _ in range(4)]
    track_cases._failed.clear()
    assert len(tried) == track_cases.GIVE_UP_AFTER
    assert said[0] == "another program keeps the tracker's database locked: end it (`fuser FILE` names it)"
    assert said[-1] == "not tried, since the cases before it could not be logged"


@pytest.mark.parametrize(
    ("config", "names"),
    [
        ("template.yaml", set()),
        ("mini.yaml", {"mini_road", "mini_scenario"}),
        ("scripted.yaml", {"layout", "behavior"}),
    ],
)
def test_the_prompts_of_a_config_are_those_that_its_model_is_asked_with(config, names):
    found = track_cases.prompts_of(load(config))
    assert set(found) == names
    assert all(found.values())


def test_a_login_is_neither_a_parameter_nor_in_the_mark(config_file):
    config = load("openai.yaml", ("backbone.base_url=http://me:secret@here/v1", "tracker.uri=http://me:secret@there"))
    assert "secret" not in str(track_cases.params_of(config))
    assert "secret" not in track_cases.mark(config.tracker, "1")
