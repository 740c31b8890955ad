"""Meddling while a command works: the database is moved, a case edited, an edit killed between facts and results."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx

from flows.case.facts_journal import journal_of, settled
from flows.case_files.case_version import version_of
from research.benchmarks.faults.kills import AGAIN_S, Undisturbed, again, undisturbed
from research.benchmarks.faults.places import Place
from research.benchmarks.faults.targets import EDIT, TARGETS, finished_case, revision, revision_faults
from research.benchmarks.services.free_port import free_port
from sgcad_core.revision import read_edits

LOOK_S = 0.001
PATIENCE_S = 120.0
Seen = tuple[str, list[str], Place]
"""What was seen, what was wrong, and where."""


def wait_for(place: Path, pattern: str) -> bool:
    """Wait until a file is there; whether it came."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if any(place.glob(pattern)):
            return True
        time.sleep(LOOK_S)
    return False


def moved(peace: Undisturbed, folder: Path) -> Seen:
    """MLflow's database is moved away in the midst of a batch; then the same command again, and with it put back."""
    place = Place(folder, peace.home)
    peace.target.prepare(folder)
    process = place.start(peace.target.command(folder))
    wait_for(folder / "out", "template/*/.tracked")
    database = folder / "out" / "mlflow.db"
    for tail in ("", "-wal", "-shm"):
        if (file := database.with_name(f"mlflow.db{tail}")).exists():
            file.rename(folder / file.name)
    code = process.wait(AGAIN_S)
    faults = [f"still runs: {line}" for line in place.wait_for_all()] + _traces(place)
    faults += again(peace, place)
    return f"exit {code}", faults, place


def edited(peace: Undisturbed, folder: Path) -> Seen:
    """A case that a batch has finished is edited while the batch works on; then the same command again."""
    place = Place(folder, peace.home)
    peace.target.prepare(folder)
    process = place.start(peace.target.command(folder))
    wait_for(folder / "out", "template/*/result.json")
    case = next(file.parent for file in folder.glob("out/template/*/result.json"))
    edit = ["revise", str(case.relative_to(folder)), "--set", "vehicles.V1.kind=suv", "--who", "ann"]
    done = place.start(["-c", "from flows.cli import main; main()", *edit]).wait(AGAIN_S)
    code = process.wait(AGAIN_S)
    faults = [f"still runs: {line}" for line in place.wait_for_all()] + _traces(place)
    told = _facts_told(case)
    rerun = place.start(peace.target.command(folder)).wait(AGAIN_S)
    faults += [] if (code, done, rerun) == (0, 0, 0) else [f"exit codes {code} (batch), {done} (edit), {rerun} (again)"]
    kept = read_edits(folder / "cases" / case.name / "facts.yaml")
    faults += [] if len(kept) == 1 else [f"{len(kept)} facts are kept"]
    faults += [] if told == 1 else [f"the edited case tells of {told} facts by a person"]
    faults += [f"still runs: {line}" for line in place.wait_for_all()] + _traces(place)
    return f"exit {code}, {done}, {rerun}", faults, place


def between(peace: Undisturbed, folder: Path) -> Seen:
    """`sgcad revise` is killed between writing facts and results; then the same edit again."""
    del peace  # it needs a finished case, not a batch
    whole = undisturbed(TARGETS["revise"], folder.with_name(f"{folder.name}-peace"))
    place = Place(folder)
    finished_case(folder)
    process = place.start(revision(folder))
    hit = _kill_at(process, journal_of(folder / "cases" / "c" / "facts.yaml"))
    place.wait_for_all()
    faults = [] if hit else ["the edit was over before it was killed"]
    settled(folder / "cases" / "c")  # as the next look at the case does
    edits = read_edits(folder / "cases" / "c" / "facts.yaml")
    told = _facts_told(folder / "out" / "template" / "c")
    faults += [] if len(edits) == told else [f"{len(edits)} facts are kept, the result tells of {told}"]
    code = place.start(revision(folder)).wait(AGAIN_S)
    faults += [] if code == 0 else [f"the same edit again ends with {code}"]
    faults += revision_faults(folder, whole.place.folder) + _traces(place)
    whole.place.remove()
    return f"killed{'' if hit else ' too late'}, {'kept' if edits else 'taken back'}", faults, place


def desk(peace: Undisturbed, folder: Path) -> Seen:
    """A desk with its workers is killed between writing facts and results of an edit; then a new desk looks."""
    del peace  # it needs a finished case, not a batch
    place = Place(folder)
    finished_case(folder)
    facts, case = folder / "cases" / "c" / "facts.yaml", folder / "out" / "template" / "c"
    with _serving(place) as address:
        asking = threading.Thread(target=_ask_to_edit, args=(address, case), daemon=True)
        asking.start()
        hit = _wait_while(asking, journal_of(facts))
        for process in place.alive():
            process.kill()
    place.wait_for_all()
    faults = [] if hit else ["the edit was over before the desk was killed"]
    with _serving(place) as address:
        shown = httpx.get(f"{address}/case/template/c", timeout=PATIENCE_S).status_code
    faults += [f"still runs: {line}" for line in place.wait_for_all()] + _traces(place)
    edits, told = read_edits(facts), _facts_told(case)
    faults += [] if shown == 200 else [f"the case's page ends with {shown}"]
    faults += [] if len(edits) == told else [f"{len(edits)} facts are kept, the result tells of {told}"]
    return f"killed{'' if hit else ' too late'}, {'kept' if edits else 'taken back'}", faults, place


@contextmanager
def _serving(place: Place) -> Iterator[str]:
    """The address of a desk over the results of a place; it is stopped with the block."""
    port = free_port()
    served = ["desk", "open", "out", "--port", str(port)]
    process = place.start(["-c", "from flows.cli import main; main()", *served])
    address, deadline = f"http://127.0.0.1:{port}", time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < deadline:
        with suppress(httpx.HTTPError):
            httpx.get(address, timeout=PATIENCE_S)
            break
        time.sleep(0.1)
    try:
        yield address
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


def _ask_to_edit(address: str, case: Path) -> None:
    field, _, value = EDIT.partition("=")
    body = {"version": version_of(case), "stamp": "", "edits": {field: value}, "who": "ann"}
    with suppress(httpx.HTTPError), httpx.Client(base_url=address, timeout=PATIENCE_S) as browser:
        token = browser.get("/").text.partition('name="desk-token" content="')[2].partition('"')[0]
        told = browser.post("/edit/template/c", json=body, headers={"x-desk-token": token})
        sys.stderr.write(f"the desk answered {told.status_code}: {told.text[:200]}\n")


def _wait_while(asking: threading.Thread, file: Path) -> bool:
    """Wait until a file is there; whether it came before the thread had ended."""
    while asking.is_alive():
        if file.exists():
            return True
        time.sleep(LOOK_S)
    return False


def _facts_told(case: Path) -> int:
    """Facts by a person of which a case's result tells."""
    person = json.loads((case / "result.json").read_text(encoding="utf-8")).get("person") or {}
    return int(person.get("facts", 0))


def _kill_at(process: subprocess.Popen[bytes], file: Path) -> bool:
    """Kill a process as soon as a file is there; whether it was in time."""
    while process.poll() is None:
        if file.exists():
            process.send_signal(signal.SIGKILL)
            return process.wait() == -signal.SIGKILL
        time.sleep(LOOK_S)
    return False


def _traces(place: Place) -> list[str]:
    return ["shows a traceback"] if "Traceback (most recent call last)" in place.said() else []
