"""`sgcad plugins new` writes packages that install, pass their own tests and run a report."""

import json

import pytest
import yaml

from flows import scaffolding
from sgcad_core import settings
from sgcad_core.entry_points import KINDS
from sgcad_core.errors import ConfigError
from tests.packaging.conftest import ROOT


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        ("validater", "mine", r"unknown kind 'validater'. Did you mean 'validator'\? Kinds: report_reader"),
        ("validator", "My-One", r"name 'My-One': use lower-case letters, digits and _"),
        ("validator", "topology", r"validator 'topology' is installed already \(plugins.validator.topology:Topology\)"),
    ],
)
def test_what_cannot_be_a_plugin_is_named(tmp_path, kind, name, message):
    with pytest.raises(ConfigError, match=message):
        scaffolding.new(kind, name, tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_package_that_is_there_is_left_alone(tmp_path):
    (tmp_path / "sgcad-mine").mkdir()
    with pytest.raises(ConfigError, match="exists already: nothing was written"):
        scaffolding.new("decoder", "mine", tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_the_config_is_the_difference_to_a_bundled_one(tmp_path, kind):
    scaffolding.new(kind, "mine", tmp_path)
    told = yaml.safe_load((tmp_path / "sgcad-mine" / "mine.yaml").read_text())
    assert (settings.CONFIGS / told["extends"]).is_file()
    assert "mine" in str(told.get(kind, told.get("validators"))) or kind == "driver"


@pytest.mark.slow
def test_packages_of_all_kinds_install_pass_their_tests_and_run_a_report(environment, tmp_path):
    for kind in KINDS:
        scaffolding.new(kind, f"mine_{kind}", tmp_path)
    packages = sorted(tmp_path.iterdir())
    environment.install(*packages, cwd=tmp_path)
    tests = [package / "tests" for package in packages]
    done = environment.run("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "passed" in done.stdout
    listed = environment.run("sgcad", "plugins", "list", cwd=tmp_path)
    assert "sgcad-mine-validator: sgcad_mine_validator:MineValidator" in listed.stdout
    (tmp_path / "knowledge.txt").write_text("roads have lanes")
    for kind in ("retriever", "backbone", "decoder"):
        config = tmp_path / f"sgcad-mine-{kind.replace('_', '-')}" / f"mine_{kind}.yaml"
        assert environment.run("sgcad", "check", config, cwd=tmp_path).returncode == 0, kind
    config = tmp_path / "sgcad-mine-validator" / "mine_validator.yaml"
    report = ROOT / "docs" / "demo" / "rear-end-on-arterial"
    words = ["run", report, "--config", config, "--set", "tracker=none", "--out", tmp_path / "out"]
    ran = environment.run("sgcad", *words, cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    result = tmp_path / "out" / "mine_validator" / report.name / "result.json"
    assert json.loads(result.read_text())["status"] == "generated"
