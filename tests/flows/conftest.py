"""A stranger's distribution of small plugins, installed while flow tests run, and reports for them."""

import os
import sys
from pathlib import Path

import pytest
import yaml

from sgcad_core import registry

DISTRIBUTION = Path(__file__).parent / "testkit_dist"
RAW = {
    "report_reader": "auto",
    "retriever": "none",
    "road_writer": "testkit",
    "scenario_writer": "testkit",
    "validators": ["testkit"],
    "simulator": "testkit",
    "tracker": "none",
}
TEXT = "The crash occurred on a two lane road in daylight. Vehicle #1 struck the back of Vehicle #2. {word}"


@pytest.fixture(autouse=True)
def testkit(monkeypatch):
    """Installs the distribution for this process and for those it starts."""
    monkeypatch.syspath_prepend(str(DISTRIBUTION))
    paths = [str(DISTRIBUTION), *filter(None, [os.environ.get("PYTHONPATH")])]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    registry.catalogue.cache_clear()
    registry.plugin_class.cache_clear()
    yield sys.modules.get("sgcad_testkit")
    registry.catalogue.cache_clear()
    registry.plugin_class.cache_clear()


@pytest.fixture
def config_file(tmp_path):
    """Writes a config: `config_file("name", tracker="jsonl")`."""

    def write(name="kit", **changes):
        file = tmp_path / f"{name}.yaml"
        file.write_text(yaml.safe_dump(RAW | changes))
        return file

    return write


@pytest.fixture
def reports(tmp_path):
    """Writes case folders: `reports(c1="", c2="REFUSE")` gives their folder."""

    def write(**words):
        folder = tmp_path / "cases"
        for name, word in words.items():
            (folder / name).mkdir(parents=True)
            (folder / name / "report.txt").write_text(TEXT.format(word=word))
        return folder

    return write
