"""An arm of a study named as a config, and results that do not know how a config is written."""

import pytest
import yaml

from flows.batch import config_folder
from flows.batch.plan_batch import batch_of
from flows.case_files import find_cases
from flows.study_file.arm_config import load_config
from sgcad_core.config import load
from sgcad_core.errors import ConfigError


@pytest.fixture
def study(tmp_path, config_file):
    """A study file of one arm beside its config."""
    config_file()
    file = tmp_path / "kits.yaml"
    file.write_text(
        yaml.safe_dump({"title": "Kits", "config": "kit.yaml", "arms": [{"name": "one", "set": {"seed": 7}}]})
    )
    return file


def test_an_arm_is_a_config_under_its_own_name(study):
    found = load_config(study / "one")
    assert (found.name, found.seed, found.extends) == ("kits-one", 7, "kit.yaml")
    assert found.raw == load(study.parent / "kit.yaml").raw | {"seed": 7}


def test_overrides_of_the_command_line_win(study):
    assert load_config(study / "one", ("seed=9",)).seed == 9


def test_an_arm_that_is_not_there_is_told_with_those_that_are(study):
    with pytest.raises(ConfigError, match=r"study kits: no arm 'on'. Did you mean 'one'\? Arms: one"):
        load_config(study / "on")


def test_a_fault_in_an_arms_config_names_study_and_arm(study):
    with pytest.raises(ConfigError, match=r"kits.yaml: arm 'one': .*kit.yaml: 1 fault\(s\)\n  sede: unknown key"):
        load_config(study / "one", ("sede=1",))


def test_a_bundled_arm_goes_by_study_and_name():
    assert (
        load_config("components_qwen72b/cad_only").raw
        == load("paper/qwen72b_sg_cadvlm.yaml", ("report_reader.use_diagrams=false",)).raw
    )


def test_a_path_that_is_no_study_is_a_config():
    assert load_config("paper/tbg.yaml").name == "paper-tbg"
    with pytest.raises(ConfigError, match=r"paper/tbgg.yaml: no such config. Did you mean 'paper/tbg'"):
        load_config("paper/tbgg.yaml")


def test_a_batch_takes_arms_and_files_alike(study, reports, tmp_path):
    made = batch_of(find_cases.cases_in([reports(c1="")]), [study / "one", tmp_path / "kit.yaml"], tmp_path / "out")
    assert [config.name for config in made.configs] == ["kits-one", "kit"]


def test_a_digest_and_what_is_kept_do_not_know_how_a_config_is_written(config_file, tmp_path):
    whole = config_file("one", seed=3, validators=["testkit"])
    before = load(whole)
    config_file("base")
    whole.write_text("extends: base.yaml\nseed: 3\n")
    after = load(whole)
    assert find_cases.config_digest(after) == find_cases.config_digest(before)
    config_folder.write(tmp_path / "kept", after)
    assert yaml.safe_load((tmp_path / "kept" / config_folder.CONFIG).read_text()) == before.raw
    assert config_folder.replaced(tmp_path / "kept", before) == ""
