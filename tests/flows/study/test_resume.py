"""A study is found again by its name."""

import shutil
from pathlib import Path

import pytest
import yaml

from flows.study import resume
from flows.study.plan import plan
from flows.study_file.spec import load_study
from sgcad_core.errors import ConfigError


@pytest.fixture
def begun(tmp_path, config_file, reports):
    config_file()
    file = tmp_path / "kits.yaml"
    file.write_text(yaml.safe_dump({"title": "Kits", "arms": [{"name": "one", "config": "kit.yaml"}]}))
    plan(load_study(file), tmp_path / "out", cases=[reports(a="")], truth=tmp_path, overrides=("seed=3",)).write()
    return file


def test_a_study_goes_on_by_its_name_with_what_it_was_given(begun, tmp_path):
    known = resume.former_arguments(Path("kits"), tmp_path / "out")
    assert (known.file, known.truth, known.overrides) == (begun, tmp_path, ("seed=3",))
    assert resume.cases_of(known, ()) == (tmp_path / "cases",)
    assert resume.cases_of(known, (tmp_path,)) == (tmp_path,)


def test_another_study_of_that_name_begins_anew(begun, tmp_path):
    other = tmp_path / "elsewhere" / "kits.yaml"
    other.parent.mkdir()
    shutil.copy(begun, other)
    assert resume.former_arguments(other, tmp_path / "out") == resume.FormerArguments(other)
    assert resume.former_arguments(Path("nothing"), tmp_path / "out") == resume.FormerArguments(Path("nothing"))


def test_cases_that_are_gone_are_told(begun, tmp_path):
    shutil.rmtree(tmp_path / "cases")
    known = resume.former_arguments(Path("kits"), tmp_path / "out")
    with pytest.raises(ConfigError, match=r"the study was started with .*cases, which is gone: name the folder"):
        resume.cases_of(known, ())
