"""A stranger's distribution of small plugins, installed while flow tests run, reports for them, and the command."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from flows import cli, command_end
from sgcad_core import entry_points, registry

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
    entry_points.read.cache_clear()
    registry.plugin_class.cache_clear()
    yield sys.modules.get("sgcad_testkit")
    entry_points.read.cache_clear()
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


@pytest.fixture
def here(monkeypatch, capsys):
    """The command in this process, for what ends before anything starts: a process of its own takes a second."""

    def leave(code):
        raise SystemExit(code)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["sgcad", *map(str, arguments)])
        monkeypatch.setattr(command_end, "leave", leave)
        monkeypatch.setattr(cli, "leave", leave)
        heeded = signal.getsignal(signal.SIGINT)
        with pytest.raises(SystemExit) as ended:
            cli.main()
        signal.signal(signal.SIGINT, heeded)
        return subprocess.CompletedProcess(arguments, ended.value.code or 0, *capsys.readouterr())

    return run


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """One Prefect server with a home of its own; starting one a test would cost 6 s each."""
    from flows.server import Server

    patch = pytest.MonkeyPatch()
    patch.setenv("PREFECT_HOME", str(tmp_path_factory.mktemp("prefect")))
    started = Server()
    started.wait()
    yield started
    started.stop()
    patch.undo()


@pytest.fixture
def under_server(server):
    """The server, which PREFECT_API_URL names."""
    return server


@pytest.fixture(autouse=True)
def _named(request, monkeypatch):
    """Tests with the server use it; a file may have another server of that name."""
    if "server" in request.fixturenames and (address := getattr(request.getfixturevalue("server"), "address", "")):
        monkeypatch.setenv("PREFECT_API_URL", address)
