"""The inbox as flow runs: killed for real, held by another run, ended with a named state."""

import os
import signal
import subprocess
import sys
import time
from collections import Counter

import pytest

from sgcad_core.errors import ConfigError

REPORTS, KILL_AT = 20, 5
PROCESS = """
import sys
from pathlib import Path
from flows.case_files import find_cases
find_cases._code_digest = lambda: "as it is"
from flows.batch import run_batch
from flows.batch.plan_batch import batch_of
from flows.deploy.inbox.intake import Intake
from flows.deploy.storage import Place
from flows.batch.tracking.track_cases import track

inbox, config, out, staging = sys.argv[1:]

def do(found, ended):
    batch = batch_of(found, [Path(config)], Path(out), jobs=1)

    def end(job, ending, untracked):
        track(job, ending)
        ended(job.case, ending.result)

    run_batch.evaluate_alone(batch, end)

print(Intake(Place(inbox), Path(staging), settle_s=0).work(do))
"""
"""A run without Prefect, which would take longer to start than to work."""


@pytest.mark.slow
def test_a_run_killed_in_the_midst_loses_nothing_and_nothing_is_done_twice(reports, config_file, tmp_path):
    dropped = reports(**{f"r{n:02d}": f"This is report {n}." for n in range(REPORTS)})
    log = tmp_path / "tracked"
    config = config_file(tracker={"name": "testkit", "file": str(log)})
    command = [sys.executable, "-c", PROCESS, dropped, config, tmp_path / "out", tmp_path / "staging"]
    first = subprocess.Popen(list(map(str, command)), start_new_session=True)
    deadline = time.monotonic() + 240
    while len(list(dropped.glob("done/*"))) < KILL_AT and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(first.pid, signal.SIGKILL)
    assert first.wait(60) == -signal.SIGKILL
    assert subprocess.run(list(map(str, command)), timeout=240).returncode == 0
    assert len(list(dropped.glob("done/*/r*/report.txt"))) == REPORTS
    assert len(list(dropped.glob(".inbox/ledger/*.json"))) == REPORTS
    assert len(list((tmp_path / "out" / "kit").glob("*/result.json"))) == REPORTS
    assert len(Counter(log.read_text().splitlines())) == REPORTS
    assert not list(dropped.glob(".inbox/tries/*"))
    assert not list(dropped.glob("r*"))


def test_a_faulty_config_takes_nothing(config_file, tmp_path):
    from flows.deploy.inbox.inbox import inbox_flow

    (tmp_path / "inbox").mkdir()
    (tmp_path / "inbox" / "a.txt").write_text("report")
    config = str(config_file(max_attempts=99))
    with pytest.raises(ConfigError, match="max_attempts"):
        inbox_flow.fn(str(tmp_path / "inbox"), config, tmp_path / "out")
    assert [p.name for p in (tmp_path / "inbox").iterdir()] == ["a.txt"]


def test_an_address_of_no_kind_is_told(config_file, tmp_path):
    from flows.deploy.inbox.inbox import inbox_flow

    with pytest.raises(ConfigError, match="nowhere://here: cannot be opened"):
        inbox_flow.fn("nowhere://here", str(config_file()), tmp_path / "out")


FLOWS = """
import sys
from pathlib import Path
from sgcad_core import settings
settings.quiet_libraries()
from prefect.client.orchestration import get_client
from flows.deploy.inbox.inbox import _alone, inbox_flow
from flows.deploy.storage import Place

inbox, config, out = sys.argv[1:]

def run():
    state = inbox_flow(inbox, config, Path(out), settle_s=0, return_state=True)
    with get_client(sync_client=True) as client:
        named = client.read_flow_run(state.state_details.flow_run_id).name
        made = client.request("POST", "/artifacts/filter", json={
            "flow_runs": {"id": {"any_": [str(state.state_details.flow_run_id)]}},
            "artifacts": {"key": {"any_": ["inbox-cases"]}}}).json()
    print(state.name, state.message, named, dict(sorted(state.result().items())), len(made), sep="|")
    return made

made = run()
run()
with _alone(Place(inbox)):
    run()
print(made[0]["data"])
"""


@pytest.mark.slow
def test_a_run_ends_with_its_counts_an_empty_one_says_so_and_a_second_one_is_busy(
    server, reports, config_file, tmp_path
):
    inbox, config = reports(a="", b="REFUSE"), config_file()
    told = subprocess.run(
        [sys.executable, "-c", FLOWS, inbox, config, tmp_path / "out"], capture_output=True, text=True
    )
    lines = told.stdout.splitlines()
    first = "Completed|1 generated, 1 refused|inbox: 2 reports, kit|{'generated': 1, 'refused': 1}|1"
    assert lines[:2] == [first, "Empty|nothing waits|inbox, kit|{}|0"], told.stderr
    assert lines[2].startswith("Busy|flow run ")
    assert f"works {inbox}" in lines[2]
    table = lines[3:]
    assert table[0].startswith("| case | config | status | verdict |")
    assert sorted(row.split(" | ")[1:3] for row in table[2:4]) == [["kit", "generated"], ["kit", "refused"]]
