"""The wheel stands by itself: installed in a bare environment, used from an empty folder, no checkout in sight."""

import json
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
REPORT = ROOT / "docs" / "demo" / "rear-end-on-arterial" / "report.txt"
pytestmark = pytest.mark.slow


def run(command, folder, environment=None):
    given = {"PATH": "/usr/bin:/bin", "HOME": str(folder), **(environment or {})}
    return subprocess.run([*map(str, command)], cwd=folder, env=given, capture_output=True, text=True, timeout=600)


def copy_of_checkout(target):
    """What git knows or would add: a build in the checkout itself would leave a second set of entry points there."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file() and not name.startswith(("tests/", "docs/")):
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, target / name)
    return target


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """`bin` of an environment that holds our wheel, and beside it what we depend on; and an empty folder."""
    place = tmp_path_factory.mktemp("wheel")
    source = copy_of_checkout(place / "source")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w", place, source]
    made = run(build, place, {"PATH": os.environ["PATH"]})
    assert made.returncode == 0, made.stderr
    venv.create(place / "venv")
    (wheel,) = place.glob("*.whl")
    (site,) = (place / "venv" / "lib").glob("python*/site-packages")
    dependencies = [p for p in map(Path, sys.path) if p.name == "site-packages"]
    (site / "dependencies.pth").write_text("".join(f"{p}\n" for p in dependencies))
    install = [place / "venv" / "bin" / "python", "-m", "pip", "install", "-q", "--no-deps", "--force-reinstall", wheel]
    done = run(install, place)
    assert done.returncode == 0, done.stderr
    (place / "empty").mkdir()
    return place / "venv" / "bin", place / "empty"


def test_it_is_the_wheel_that_runs_and_not_the_checkout(installed):
    bin_, empty = installed
    code = "import sgcad_core, flows, plugins; print(sgcad_core.__file__)"
    done = run([bin_ / "python", "-c", code], empty)
    assert done.stdout.startswith(str(bin_.parent)), done.stderr


def test_research_is_not_in_the_wheel(installed):
    bin_, empty = installed
    done = run([bin_ / "python", "-c", "import importlib.util; print(importlib.util.find_spec('research'))"], empty)
    assert done.stdout.strip() == "None", done.stderr


@pytest.mark.parametrize(
    "name", ["template.yaml", "mini_text_only.yaml", "baselines/osm_direct", "baselines_qwen72b/omnitester"]
)
def test_every_kind_of_config_is_there(installed, name):
    bin_, empty = installed
    done = run([bin_ / "sgcad", "check", name], empty)
    assert done.returncode == 0, done.stderr
    assert ": valid;" in done.stdout


def test_a_study_is_there(installed):
    bin_, empty = installed
    done = run([bin_ / "sgcad", "check", "robustness"], empty)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("config", ["template.yaml", "mini_no_contrast.yaml", "baselines/text2scenario_rules"])
def test_a_report_becomes_a_scenario(installed, config):
    bin_, empty = installed
    (empty / "report.txt").write_bytes(REPORT.read_bytes())
    command = [bin_ / "sgcad", "run", "report.txt", "--config", config, "--out", "out", "--set", "tracker=none"]
    done = run(command, empty)
    assert done.returncode == 0, done.stdout + done.stderr
    place = empty / "out" / config.removesuffix(".yaml").replace("/", "-") / "report"
    assert json.loads((place / "result.json").read_text())["status"] == "generated"
    assert {"road.xodr", "scenario.xosc", "player.html"} <= {file.name for file in place.iterdir()}


def test_the_desk_has_its_pages(installed):
    bin_, empty = installed
    code = (
        "from pathlib import Path; from starlette.testclient import TestClient\n"
        "from flows.desk.app import application\n"
        "client = TestClient(application(Path('.')), base_url='http://localhost')\n"
        "places = ('/', '/static/desk.css', '/static/mend.js', '/case/none')\n"
        "print([client.get(place).status_code for place in places])"
    )
    done = run([bin_ / "python", "-c", code], empty)
    assert done.stdout.strip() == "[200, 200, 200, 404]", done.stderr
