"""A batch is checked whole before anything starts."""

import pytest

from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import cases_in
from sgcad_core.errors import ConfigError


def test_all_faults_of_all_configs_are_told_at_once(batch, config_file, tmp_path):
    found = cases_in([batch(a="").cases[0].source])
    bad = [config_file("one", simulator="nothing"), config_file("two", seed=-1)]
    with pytest.raises(ConfigError, match=r"(?s)one.yaml.*unknown simulator 'nothing'.*two.yaml.*seed"):
        batch_of(found, bad, tmp_path / "elsewhere")
    assert not (tmp_path / "elsewhere").exists()


def test_two_configs_of_one_name_are_refused(batch, config_file, tmp_path):
    first = config_file()
    second = tmp_path / "other" / "kit.yaml"
    second.parent.mkdir()
    second.write_text(first.read_text())
    with pytest.raises(ConfigError, match="two configs are called 'kit'"):
        batch_of(cases_in([batch(a="").cases[0].source]), [first, second], tmp_path / "out")


def test_no_jobs_is_no_number_of_jobs(batch):
    with pytest.raises(ConfigError, match="--jobs 0: at least 1 is needed"):
        batch(jobs=0, a="")


@pytest.mark.parametrize(("detail", "workers", "message"), [
    ("steps", "auto", "--detail steps: give stage or case"),
    ("stage", "ray", "--workers ray: give auto, threads, processes, dask, or the address of a Dask scheduler"),
])  # fmt: skip
def test_a_wrong_detail_or_place_is_named(batch, detail, workers, message):
    made = batch(a="")
    with pytest.raises(ConfigError, match=message):
        made.shown(detail, workers)
    assert made.shown("case", "dask").workers == "dask"
