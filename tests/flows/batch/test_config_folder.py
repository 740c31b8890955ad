"""Results of one config never take the place of another one's unseen."""

import pytest
import yaml

from flows.batch import config_folder
from flows.case_files.case_folder import CONFIG
from sgcad_core.config import load


@pytest.mark.parametrize(
    ("overrides", "name"),
    [
        ((), "kit"),
        (("max_attempts=3",), "kit-max_attempts_3"),
        (("report_reader.use_diagrams=false", "seed=1"), "kit-use_diagrams_false-seed_1"),
        (("tracker=none", "tracker.uri=http://x"), "kit"),
        (("retriever={name: none}",), "kit-none"),
        (("judge.name=esmini",), "kit"),
        (("retriever.places=maps/town.osm.bz2",), "kit-town"),
    ],
)
def test_overrides_that_change_results_are_part_of_the_folders_name(config_file, overrides, name):
    assert config_folder.named(load(config_file()), overrides).name == name


def test_the_folder_holds_the_config_that_made_it_and_no_login(config_file, tmp_path):
    config = load(config_file(), ("seed=7",))
    config.raw["tracker"] = {"name": "mlflow", "uri": "http://me:secret@host:5000"}
    config_folder.write(tmp_path / "kit", config)
    kept = yaml.safe_load((tmp_path / "kit" / CONFIG).read_text())
    assert kept["seed"] == 7
    assert kept["tracker"]["uri"] == "http://host:5000"
    assert load(tmp_path / "kit" / CONFIG).seed == 7


def test_an_edited_config_is_told_before_its_results_are_replaced(config_file, tmp_path):
    folder = tmp_path / "out" / "kit"
    config_folder.write(folder, load(config_file()))
    edited = load(config_file(seed=5))
    assert config_folder.replaced(folder, edited) == ""  # nothing there yet that could be lost
    (folder / "a").mkdir()
    (folder / "a" / "result.json").write_text("{}")
    assert "holds 1 results of another kit: seed differ" in config_folder.replaced(folder, edited)
    assert config_folder.replaced(folder, load(config_file())) == ""
    assert config_folder.replaced(folder, load(config_file(tracker="jsonl"))) == ""
