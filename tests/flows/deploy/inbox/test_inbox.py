"""The inbox with real cases and workers that are really killed."""

import os
import signal
import subprocess
import sys
import time
from collections import Counter

import pytest

from sgcad_core.errors import ConfigError

REPORTS, KILL_AT = 20, 5
WORKER = """
import sys
from pathlib import Path
from flows.case_files import find_cases
find_cases._code_digest = lambda: "as it is"
from flows.batch.plan_batch import JobRunner, batch_of
from flows.deploy.inbox.claims import Claims
from flows.deploy.inbox.intake import Intake
from flows.deploy.storage import Place
from flows.batch.track_cases import track
from sgcad_core.asking.refine import run_at_once

inbox, config, out, staging = sys.argv[1:]

def do(found, ended):
    batch = batch_of(found, [Path(config)], Path(out), jobs=1)
    plan, runner = batch.plan(), JobRunner(batch)
    runner.begin(plan)
    for job in plan:
        ending = runner.finish(job, run_at_once)
        track(job, ending)
        ended(job.case, ending.result)
    runner.close()

place = Place(inbox)
print(Intake(place, Claims(place), Path(staging), settle_s=0).work(do, 10, 120))
"""
"""A worker without Prefect, which would take longer to start than to work."""


@pytest.mark.slow
def test_a_worker_killed_in_the_midst_loses_nothing_and_nothing_is_done_twice(reports, config_file, tmp_path):
    dropped = reports(**{f"r{n:02d}": f"This is report {n}." for n in range(REPORTS)})
    log = tmp_path / "tracked"
    config = config_file(tracker={"name": "testkit", "file": str(log)})
    command = [sys.executable, "-c", WORKER, dropped, config, tmp_path / "out", tmp_path / "staging"]
    workers = [subprocess.Popen(list(map(str, command)), start_new_session=True) for _ in range(2)]
    deadline = time.monotonic() + 240
    while len(list(dropped.glob("done/*"))) < KILL_AT and time.monotonic() < deadline:
        time.sleep(0.02)
    os.kill(workers[0].pid, signal.SIGKILL)
    assert workers[0].wait(60) == -signal.SIGKILL
    assert workers[1].wait(240) == 0
    assert len(list(dropped.glob("done/*/r*/report.txt"))) == REPORTS
    assert len(list(dropped.glob(".inbox/ledger/*.json"))) == REPORTS
    assert len(list((tmp_path / "out" / "kit").glob("*/result.json"))) == REPORTS
    tracked = Counter(log.read_text().splitlines())
    assert len(tracked) == REPORTS
    assert not list(dropped.glob(".inbox/claims/*"))
    assert not list(dropped.glob("r*"))


def test_a_faulty_config_claims_nothing(config_file, tmp_path):
    from flows.deploy.inbox.inbox import inbox_flow

    (tmp_path / "inbox").mkdir()
    (tmp_path / "inbox" / "a.txt").write_text("report")
    config = str(config_file(max_attempts=99))
    with pytest.raises(ConfigError, match="max_attempts"):
        inbox_flow.fn(str(tmp_path / "inbox"), config, str(tmp_path / "out"))
    assert [p.name for p in (tmp_path / "inbox").iterdir()] == ["a.txt"]


def test_an_address_of_no_kind_is_told(config_file, tmp_path):
    from flows.deploy.inbox.inbox import inbox_flow

    with pytest.raises(ConfigError, match="nowhere://here: cannot be opened"):
        inbox_flow.fn("nowhere://here", str(config_file()), str(tmp_path / "out"))
