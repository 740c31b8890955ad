"""The command line as a person meets it: exit codes, messages, what lies on disk afterwards."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import httpx
import psutil
import pytest

CODE = (
    "from flows import cli; from flows.case_files import find_cases; "
    "find_cases._code_digest = lambda: 'as it is'; cli.main()"
)
SGCAD = [sys.executable, "-c", CODE]
"""The command; code that is edited while tests run makes no case stale."""


def sgcad(*arguments, **environment):
    """Run a command; its exit code, stdout and stderr."""
    command = [*SGCAD, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=os.environ | environment, timeout=300)


def statuses(out, config="kit"):
    found = {p.parent.name: json.loads(p.read_text())["status"] for p in (out / config).glob("*/result.json")}
    return dict(sorted(found.items()))


# ------------------------------------------------------------------ without Prefect
def test_help_takes_less_than_half_a_second_of_work():
    """Of processor time, its own: a busy machine or a neighbor's process is not counted."""
    code = (
        "import resource, sys\n"
        "try:\n"
        "    from flows import cli; cli.main()\n"
        "finally:\n"
        "    used = resource.getrusage(resource.RUSAGE_SELF); print(used.ru_utime + used.ru_stime, file=sys.stderr)\n"
    )
    ended = [subprocess.run([sys.executable, "-c", code, "--help"], capture_output=True, text=True) for _ in range(3)]
    assert "evaluate" in ended[0].stdout
    assert min(float(e.stderr.split()[-1]) for e in ended) < 0.5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"decoder": "cad", "backbone": {"name": "openai_chat", "model": "m"}}, "gives none; use decoder 'greedy'"),
        ({"simulator": {"name": "testkit", "no_such": 1}}, "simulator.no_such: unknown field. Known: died, fails"),
        ({"max_attempts": "many"}, "max_attempts: should be a valid integer"),
        ({"max_attempts": 99}, "less than or equal to 10 (found 99)"),
        ({"road_writer": "testkitt"}, "unknown road_writer 'testkitt'. Did you mean 'testkit'?"),
        ({"colour": "red"}, "colour: unknown key. Known: backbone, decoder"),
        ({"road_writer": "testkit_asking"}, "backbone: missing, but road_writer ask a model"),
    ],
    ids=["pairing", "unknown field", "wrong type", "out of range", "missing plugin", "unknown key", "no backbone"],
)
def test_a_faulty_config_starts_nothing(here, reports, config_file, tmp_path, changes, message):
    config = config_file(**({"backbone": None} | changes))
    ended = here("evaluate", reports(a=""), "--config", config, "--out", tmp_path / "out")
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"sgcad: error: {config}: ")
    assert message in ended.stderr
    assert not (tmp_path / "out").exists()


def test_a_judge_whose_program_is_missing_starts_nothing(here, reports, config_file, tmp_path, monkeypatch):
    monkeypatch.setenv("ESMINI", "/no/such/esmini")
    out = tmp_path / "out"
    command = ["evaluate", reports(a=""), "--config", config_file(), "--judge", "esmini", "--out", out]
    ended = here(*command)
    assert ended.returncode == 2
    assert "'/no/such/esmini' is no program that can be run: name the esmini binary by `path`" in ended.stderr
    assert not out.exists()


def test_the_module_is_the_command_line():
    ended = subprocess.run([sys.executable, "-m", "flows.cli", "--help"], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "evaluate" in ended.stdout
    wrong = subprocess.run([sys.executable, "-m", "flows.cli", "run", "none.txt"], capture_output=True, text=True)
    assert wrong.returncode == 2
    assert "no such report: none.txt" in wrong.stderr


def test_the_version_is_told(here):
    from importlib.metadata import version

    ended = here("--version")
    assert (ended.returncode, ended.stdout) == (0, f"sgcad {version('sg-cadvlm')}\n")


@pytest.mark.slow
def test_a_model_that_this_machine_cannot_hold_is_told_before_anything_starts():
    ended = sgcad("check", "qwen2_5_vl_72b", "--set", "backbone.model=nobody/Huge-9000B")
    assert ended.returncode == 0
    assert "qwen2_5_vl_72b: will not fit this machine: the weights take about 18000 GB" in ended.stdout
    assert "will not fit" not in sgcad("check", "mini").stdout


def test_a_tracker_that_can_never_log_starts_nothing(reports, config_file, tmp_path):
    (tmp_path / "out" / "mlflow.db").mkdir(parents=True)
    started = time.monotonic()
    ended = sgcad("evaluate", reports(a=""), "--config", config_file(tracker="mlflow"), "--out", tmp_path / "out")
    assert ended.returncode == 2
    assert "mlflow.db: is a folder, where MLflow's database would be" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert not (tmp_path / "out" / "kit" / "a").exists()
    assert time.monotonic() - started < 30


def test_an_interpreter_that_cannot_be_started_is_named(monkeypatch):
    from sgcad_core.errors import MissingTool
    from sgcad_core.system.worker_process import Worker

    monkeypatch.setattr(sys, "executable", "/no/such/python")
    with pytest.raises(MissingTool, match=r"python cannot be started \(No such file"):
        Worker("plugins.simulator._sumo_worker:replay").call("x", timeout_s=1)


@pytest.mark.slow
def test_doctor_looks_no_further_where_it_cannot_write(tmp_path):
    ended = sgcad("doctor", "--out", "/proc/runs", PREFECT_HOME="/proc/prefect")
    assert ended.returncode == 1
    assert "wrong output: --out /proc/runs: cannot be written" in ended.stdout
    assert "not checked flow: repair home, output first" in ended.stdout
    assert "not checked tracking: repair output first" in ended.stdout


def test_a_config_that_is_no_yaml_is_named(here, reports, tmp_path):
    (tmp_path / "bad.yaml").write_text("a: [1, 2")
    ended = here("run", reports(a="") / "a", "--config", tmp_path / "bad.yaml")
    assert ended.returncode == 2
    assert "bad.yaml: cannot be read as YAML" in ended.stderr


def test_a_bad_override_is_named(here, reports, config_file, tmp_path):
    ended = here("run", reports(a="") / "a", "--config", config_file(), "--set", "seed", "--out", tmp_path / "out")
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "--set 'seed': expected key=value, such as decoder.alpha=0.3" in ended.stderr


def test_an_output_folder_that_cannot_be_written_starts_nothing(here, reports, config_file):
    ended = here("run", reports(a="") / "a", "--config", config_file(), "--out", "/proc/runs")
    assert ended.returncode == 2
    assert "--out /proc/runs: cannot be written" in ended.stderr


def test_a_report_that_is_not_there_starts_nothing(here, config_file, tmp_path):
    ended = here("run", tmp_path / "nowhere", "--config", config_file())
    assert ended.returncode == 2
    assert "no such report" in ended.stderr


def test_check_shows_what_a_config_would_do(config_file):
    ended = sgcad("check", config_file())
    assert ended.returncode == 0
    rows = [line.split()[:4] for line in ended.stdout.splitlines()]
    assert ["\u2502", "road_writer", "\u2502", "testkit"] in rows


def test_plugins_of_strangers_are_listed_and_shown():
    assert "sgcad-testkit: sgcad_testkit:KitRoad" in sgcad("plugins", "list", COLUMNS="200").stdout
    shown = sgcad("plugins", "show", "simulator/testkit")
    assert "fails" in shown.stdout
    assert "boolean" in shown.stdout
    missing = sgcad("plugins", "show", "testkitt")
    assert missing.returncode == 2
    assert "no plugin 'testkitt'; installed: backbone/" in missing.stderr


def test_a_single_report_needs_no_server_tells_its_steps_and_is_tracked_afterwards(reports, config_file, tmp_path):
    log, out = tmp_path / "log", tmp_path / "out"
    config = config_file(tracker={"name": "testkit", "file": str(log)})
    ended = sgcad("run", reports(a="") / "a", "--config", config, "--out", out, PREFECT_HOME=str(tmp_path / "home"))
    assert ended.returncode == 0, ended.stderr
    steps = ["read", "road[1]", "scenario[1]", "simulate", "draw"]
    assert [line.rpartition(" ")[2] for line in ended.stderr.splitlines()][: len(steps)] == steps
    assert not (tmp_path / "home").exists()
    deadline = time.monotonic() + 120
    while not log.exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    assert log.read_text() == "kit/a generated\n"


# ------------------------------------------------------------------ with a Prefect server for all
@pytest.mark.slow
def test_a_batch_ends_case_by_case_and_running_again_only_does_what_is_left(server, reports, config_file, tmp_path):
    folder = reports(a="", b="REFUSE", c="RAISE")
    configs = ["--config", config_file(), "--config", config_file("other")]
    arguments = ["evaluate", folder, *configs, "--out", tmp_path / "out"]
    ended = sgcad(*arguments)
    assert ended.returncode == 1, ended.stderr
    expected = {"a": "generated", "b": "refused", "c": "failed"}
    assert statuses(tmp_path / "out") == statuses(tmp_path / "out", "other") == expected
    assert (
        "kit/c: failed: road_writer 'testkit' (sgcad_testkit:KitRoad): write raised ZeroDivisionError" in ended.stdout
    )
    assert f"look at: {tmp_path}/out/kit/a/player.html" in ended.stdout
    assert "Traceback" not in ended.stderr
    again = sgcad(*arguments)
    row = next(line for line in again.stdout.splitlines() if line.split()[:1] == ["kit"]).split()
    assert row[1:8] == ["1", "1", "0", "1", "1/1", "0/1", "2"]


@pytest.mark.slow
def test_prefect_shows_every_step_of_a_case_what_it_waited_for_and_an_artifact(server, reports, config_file, tmp_path):
    sgcad("evaluate", reports(a="", b="REPAIR"), "--config", config_file(), "--out", tmp_path / "out")
    asking = config_file(
        "asking", road_writer="testkit_asking", decoder="greedy", backbone={"name": "scripted", "answers": ["no", "ok"]}
    )
    assert sgcad("run", tmp_path / "cases" / "a", "--config", asking, "--out", tmp_path / "out").returncode == 0
    expected = {
        ("kit/a", "Lacking"),
        ("kit/b", "Exhausted"),
        ("asking/a", "Doubted"),
        ("road[1]", "Accepted"),
        ("road[1]", "Repair"),
        ("road[2]", "Accepted"),
        ("track kit/a", "Completed"),
        ("track kit/b", "Completed"),
        ("track asking/a", "Completed"),
    }
    links = {name: json.loads((tmp_path / "out" / name / "a" / "links.json").read_text()) for name in ("kit", "asking")}
    run, asking_run = (links[name]["prefect"].rpartition("/runs/flow-run/")[2] for name in ("kit", "asking"))
    names = {found["id"]: found["name"] for found in asked(server, "flow_runs/filter")}
    assert (names[run], names[asking_run]) == ("kit over 2 reports", "asking over a")
    assert expected <= states_of_tasks(server, [run, asking_run], expected)
    shown, edges, inside = graph_of(server, run)
    assert {("kit/a", "COMPLETED"), ("kit/b", "FAILED"), ("read", "COMPLETED"), ("measure", "COMPLETED")} <= shown
    assert {
        ("read", "retrieve[road]"),
        ("retrieve[road]", "road[1]"),
        ("road[1]", "scenario[1]"),
        ("scenario[1]", "simulate"),
        ("simulate", "measure"),
        ("kit/a", "track kit/a"),
        ("kit/b", "track kit/b"),
    } <= edges
    assert inside == {"kit/a", "kit/b"}
    assert ("road[1]", "road[2]") in graph_of(server, asking_run)[1]
    found = asked(server, "artifacts/filter")
    told = {a["key"]: a for a in found if a["flow_run_id"] == run}
    assert links["kit"]["prefect_case"].endswith(told["kit-a"]["task_run_id"])
    assert "![The crash from above](data:image/png;base64," in told["kit-a"]["data"]
    assert "| told | in the scenario | lacking | assumed |" in told["kit-a"]["data"]


def asked(server, path, **body):
    """What Prefect's server answers."""
    return httpx.post(f"{server.address}/{path}", json=body, timeout=30).json()


def states_of_tasks(server, runs, expected, seconds=60):
    """Names and states of the task runs of flow runs once those expected are there; a server writes them afterwards."""
    deadline = time.monotonic() + seconds
    while True:
        found = asked(server, "task_runs/filter", flow_runs={"id": {"any_": runs}})
        states = {(run["name"], run["state_name"]) for run in found}
        if expected <= states or time.monotonic() > deadline:
            return states
        time.sleep(0.2)


def graph_of(server, run):
    """A flow run's graph: (task run, kind of state), who waited for whom, inside of what."""
    nodes = dict(httpx.get(f"{server.address}/flow_runs/{run}/graph-v2", timeout=30).json()["nodes"])
    name = {key: node["label"] for key, node in nodes.items()}
    edges = {(name[up["id"]], node["label"]) for node in nodes.values() for up in node["parents"]}
    inside = {name[around["id"]] for node in nodes.values() for around in node["encapsulating"]}
    return {(node["label"], node["state_type"]) for node in nodes.values()}, edges, inside


@pytest.mark.slow
def test_refusals_and_good_cases_are_no_fault(server, reports, config_file, tmp_path):
    folder = reports(a="", b="REFUSE")
    ended = sgcad("run", folder / "a", folder / "b", "--config", config_file(), "--out", tmp_path / "out")
    assert ended.returncode == 0


@pytest.mark.slow
def test_a_missing_tool_ends_the_batch_with_its_remedy(server, reports, config_file, tmp_path):
    ended = sgcad("evaluate", reports(a="TOOLLESS"), "--config", config_file(), "--out", tmp_path / "out")
    assert ended.returncode == 2
    assert ended.stderr.rstrip().endswith("sgcad: error: netconvert is not installed: pip install eclipse-sumo")


@pytest.mark.slow
def test_a_tracker_that_fails_costs_no_case_and_the_next_run_logs(server, reports, config_file, tmp_path):
    folder, log = reports(a="", b=""), tmp_path / "log"
    broken = config_file(tracker={"name": "testkit", "file": str(log), "raises": True})
    ended = sgcad("evaluate", folder, "--config", broken, "--out", tmp_path / "out")
    assert ended.returncode == 0
    assert "2 not logged; run the same command again to log them; kit/" in ended.stdout
    mended = config_file(tracker={"name": "testkit", "file": str(log)})
    for _ in range(2):
        assert sgcad("evaluate", folder, "--config", mended, "--out", tmp_path / "out").returncode == 0
    assert sorted(log.read_text().splitlines()) == ["kit/a generated", "kit/b generated"]


def started(folder, config, out):
    """A batch in a session of its own, once its first case is done."""
    command = [*SGCAD, "evaluate", str(folder), "--config", str(config), "--out", str(out), "--jobs", "1"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, start_new_session=True, **pipes)
    deadline = time.monotonic() + 120
    while not (out / "kit" / "a" / "result.json").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    return process


def descendants(process):
    return psutil.Process(process.pid).children(recursive=True)


def gone(processes, seconds=15):
    deadline = time.monotonic() + seconds
    while any(p.is_running() and p.status() != "zombie" for p in processes) and time.monotonic() < deadline:
        time.sleep(0.1)
    return not any(p.is_running() and p.status() != "zombie" for p in processes)


@pytest.mark.slow
def test_an_interrupted_batch_ends_with_130_and_keeps_what_is_done(reports, config_file, tmp_path, server):
    folder, config = reports(a="", b="SLOW SLOW", c="SLOW"), config_file()
    (temporary := tmp_path / "temporary").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(temporary))
        process = started(folder, config, tmp_path / "out")
    children = descendants(process)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 130, errors
    assert "sgcad: interrupted; finished cases are kept" in errors
    assert gone(children)
    assert statuses(tmp_path / "out")["a"] == "generated"
    assert "failed" not in statuses(tmp_path / "out").values()
    assert not [file.name for file in temporary.iterdir() if file.name.startswith("sgcad-")]
    assert not list((tmp_path / "out" / "kit").glob(".partial-*"))


INTERRUPTED = """
import os, signal, sys, threading, time
from pathlib import Path
from flows import cli
from flows.batch import run_batch
from flows.case_files.case_folder import CaseFolder
from sgcad_core.system.temp_folders import temp_folder


def hold(out):
    with temp_folder("test"), CaseFolder(out, "kit", "c").writing():
        time.sleep(60)


def evaluate(made, on_ending, on_step=None):
    threading.Thread(target=hold, args=(made.out,), daemon=True).start()
    time.sleep(1)
    print(len(os.listdir(os.environ["TMPDIR"])), flush=True)
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(9)


run_batch.evaluate = evaluate
cli.main()
"""


def test_an_interrupt_leaves_no_temporary_folder_of_a_thread(reports, config_file, tmp_path):
    (temporary := tmp_path / "temporary").mkdir()
    command = ["evaluate", reports(a=""), "--config", config_file(), "--out", tmp_path / "out"]
    ended = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, *map(str, command)], capture_output=True, text=True,
        env=os.environ | {"TMPDIR": str(temporary)},
    )  # fmt: skip
    assert (ended.returncode, ended.stdout.strip()) == (130, "1"), ended.stderr
    assert not list(temporary.iterdir())
    assert not list((tmp_path / "out" / "kit").glob(".partial-*"))


def test_an_interrupt_that_a_library_turns_into_its_own_error_is_still_an_interrupt(reports, config_file, tmp_path):
    """Pydantic does so while it serializes, as Prefect makes it do when it is imported."""
    code = (
        "import os, signal, time; from flows import cli; from flows.batch import run_batch\n"
        "def evaluate(made, on_ending, on_step=None):\n"
        "    try:\n"
        "        os.kill(os.getpid(), signal.SIGINT); time.sleep(9)\n"
        "    except KeyboardInterrupt as fault:\n"
        "        raise ValueError('Error calling function') from fault\n"
        "run_batch.evaluate = evaluate; cli.main()\n"
    )
    command = ["evaluate", reports(a=""), "--config", config_file(), "--out", tmp_path / "out"]
    ended = subprocess.run([sys.executable, "-c", code, *map(str, command)], capture_output=True, text=True)
    assert ended.returncode == 130, ended.stderr
    assert ended.stderr.rstrip().endswith("run the same command again to go on")


@pytest.mark.slow
def test_a_killed_batch_goes_on_where_it_stopped_and_leaves_no_process(reports, config_file, tmp_path):
    """With a server of its own: that too must end."""
    folder, config = reports(a="", b="SLOW", c=""), config_file()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PREFECT_HOME", str(tmp_path / "prefect"))
        patch.delenv("PREFECT_API_URL", raising=False)
        process = started(folder, config, tmp_path / "out")
        children = descendants(process)
        process.kill()
        process.communicate(timeout=30)
        assert process.returncode == -signal.SIGKILL
        assert len(children) >= 2
        assert gone(children)
        before = (tmp_path / "out" / "kit" / "a" / "result.json").stat().st_mtime_ns
        again = sgcad("evaluate", folder, "--config", config, "--out", tmp_path / "out")
    assert again.returncode == 0, again.stderr
    assert statuses(tmp_path / "out") == {"a": "generated", "b": "generated", "c": "generated"}
    assert (tmp_path / "out" / "kit" / "a" / "result.json").stat().st_mtime_ns == before
    assert not list((tmp_path / "out" / "kit").glob(".partial-*"))


@pytest.mark.slow
@pytest.mark.parametrize("when", ["as it starts", "after the first case"])
def test_a_batch_whose_prefect_server_is_killed_ends_under_another(server, reports, config_file, tmp_path, when):
    """No case needs the server; before, a traceback ended the batch."""
    folder, config, out = reports(a="", b="SLOW", c=""), config_file(), tmp_path / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("PREFECT_API_URL")
        command = [*SGCAD, "evaluate", str(folder), "--config", str(config), "--out", str(out)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while when != "as it starts" and not (out / "kit" / "a" / "result.json").is_file():
            time.sleep(0.02)
        _server_of(process).kill()
        said, complaints = process.communicate(timeout=200)
    assert process.returncode == 0, complaints
    assert "Prefect's server was killed by signal 9; another one is started" in complaints
    assert "Traceback" not in complaints
    assert statuses(out) == {"a": "generated", "b": "generated", "c": "generated"}
    row = next(line for line in said.splitlines() if line.split()[:1] == ["kit"]).split()
    assert row[1:4] == ["3", "0", "0"]


def _server_of(process):
    while True:
        for child in psutil.Process(process.pid).children():
            if "flows.server" in child.cmdline():
                return child
        time.sleep(0.02)


@pytest.mark.slow
def test_a_deployed_flow_does_the_same_from_plain_parameters(server, reports, config_file, tmp_path):
    folder, config, out = reports(a="", b="REFUSE"), config_file(), tmp_path / "out"
    code = (
        "import sys; from flows.deploy.evaluate import evaluate_flow\n"
        "folder, config, out = sys.argv[1:]\n"
        "print(evaluate_flow([folder], [config], out, jobs=1))\n"
    )
    ended = subprocess.run([sys.executable, "-c", code, folder, config, out], capture_output=True, text=True)
    assert ended.stdout.splitlines() == ["{'generated': 1, 'refused': 1}"], ended.stderr


def test_a_named_server_that_does_not_answer_starts_nothing(reports, config_file, tmp_path):
    command = ["run", reports(a="") / "a", "--config", config_file(), "--out", tmp_path / "out"]
    ended = sgcad(*command, PREFECT_API_URL="http://127.0.0.1:9/api")
    assert ended.returncode == 2
    assert "PREFECT_API_URL names http://127.0.0.1:9/api, where no Prefect server answers" in ended.stderr
    assert statuses(tmp_path / "out") == {}


@pytest.mark.slow
def test_doctor_tries_a_real_flow_and_a_real_database(server, tmp_path):
    ended = sgcad("doctor", "--services", "--out", tmp_path / "out")
    lines = {line.split(":")[0].split()[-1]: line for line in ended.stdout.splitlines()}
    assert lines["flow"].startswith("ok")
    assert lines["tracking"].startswith("ok")
    assert lines["netconvert"].startswith("ok")
    assert not Path(tmp_path / "out").exists()
