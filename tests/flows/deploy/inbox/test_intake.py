"""The inbox: every report done once and put where it belongs, whoever dies in between."""

import json
import os
import time
import uuid
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from flows.deploy.inbox.claims import MAX_TAKES, Claims
from flows.deploy.inbox.intake import LEDGER, Intake
from flows.deploy.storage import Place


@pytest.fixture(params=["local", "memory"])
def place(request, tmp_path):
    """An inbox on local files, and one on a store without renames."""
    if request.param == "local":
        return Place(str(tmp_path / "inbox"))
    return Place(f"memory://{uuid.uuid4().hex}")


@pytest.fixture
def intake(tmp_path):
    """Makes one worker's view of an inbox."""
    return lambda place, lease_s=3600.0, settle_s=0.0: Intake(
        place, Claims(place, lease_s), tmp_path / uuid.uuid4().hex, settle_s
    )


def by_word(cases, ended):
    """Runs cases: a report's first word is its status."""
    for case in cases:
        text = (case.source / "report.txt" if case.source.is_dir() else case.source).read_text()
        ended(case, {"status": text.split()[0], "reason": "because", "missing": ["lanes"]})


def files(place, folder):
    """Paths of all files below a folder of the inbox, hidden ones too."""
    return sorted(path.split(f"{place.root}/", 1)[1] for path in place.fs.find(place.path(folder)))


def test_reports_go_where_their_ending_says(place, intake):
    place.write("a.txt", b"generated 1")
    place.write("b.txt", b"refused 2")
    place.write("c.txt", b"failed 3")
    place.write("case/report.txt", b"exhausted 4")
    place.write("case/diagram.png", b"png")
    counts = intake(place).work(by_word, 2, 0)
    assert counts == {"generated": 1, "refused": 1, "failed": 1, "exhausted": 1}
    moved = [p for folder in ("done", "refused", "failed") for p in files(place, folder)]
    assert [Path(p).name for p in moved if not p.endswith("outcome.json")] == [
        "a.txt", "b.txt", "c.txt", "diagram.png", "report.txt",
    ]  # fmt: skip
    outcome = json.loads(place.read(next(p for p in files(place, "refused") if p.endswith("outcome.json"))))
    assert outcome["missing"] == ["lanes"]
    assert [e.name for e in place.entries()] == ["done", "failed", "refused"]
    assert files(place, ".inbox/claims") == []


def test_what_nobody_reads_is_put_apart_with_the_reason(place, intake):
    place.write("letter.docx", b"word")
    place.write("noise", b"?")
    place.write("half.docx.part", b"wo")
    assert intake(place).work(by_word, 5, 0) == {"unread": 2, "no_report": 1}
    assert [Path(p).name for p in files(place, "unread") if not p.endswith("outcome.json")] == ["letter.docx", "noise"]
    outcome = json.loads(place.read("unread/letter.docx/outcome.json"))
    assert outcome["status"] == "unread"
    assert "letter.docx cannot be read (.docx): give .pdf, .txt, .xml, or a folder" in outcome["reason"]
    assert intake(place).work(by_word, 5, 0) == {"no_report": 1}


def test_an_outcome_points_to_its_result(tmp_path):
    def do(cases, ended):
        for case in cases:
            ended(case, {"status": "generated", "reason": "", "missing": [], "config": "template-seed_4"})

    place = Place(str(tmp_path / "inbox"))
    place.write("a.txt", b"text")
    Intake(place, Claims(place), tmp_path / "staging", 0, "template.yaml", tmp_path / "runs").work(do, 5, 0)
    (outcome,) = (tmp_path / "inbox" / "done").glob("*/outcome.json")
    told = json.loads(outcome.read_text())
    assert told["result"] == str(tmp_path / "runs" / "template-seed_4" / told["case"])


def test_an_empty_inbox_is_watched_and_a_drop_is_taken_in_seconds(tmp_path, intake):
    place = Place(str(tmp_path / "inbox"))
    seen = []

    def do(cases, ended):
        seen.append(time.monotonic())
        by_word(cases, ended)

    with ThreadPoolExecutor(1) as pool:
        working = pool.submit(intake(place).work, do, 5, 0, 6.0)
        time.sleep(1.5)
        dropped = time.monotonic()
        place.write("a.txt", b"generated")
        assert working.result(30) == {"generated": 1}
    assert seen[0] - dropped < 3


def test_the_same_report_twice_is_done_once_whatever_it_is_called(place, intake):
    done = []

    def do(cases, ended):
        done.extend(c.id for c in cases)
        by_word(cases, ended)

    place.write("a.txt", b"generated")
    place.write("b.txt", b"generated")
    assert intake(place).work(do, 5, 0) == {"generated": 1, "again": 1}
    place.write("a.txt", b"generated")
    assert intake(place).work(do, 5, 0) == {"again": 1}
    assert len(done) == len(files(place, LEDGER)) == 1


def test_a_failed_report_may_be_dropped_again(place, intake):
    for _ in range(2):
        place.write("a.txt", b"failed")
        assert intake(place).work(by_word, 5, 0) == {"failed": 1}


def test_two_reports_of_one_name_are_two_cases(place, intake):
    for text in (b"generated 1", b"generated 2"):
        place.write("report.txt", text)
        intake(place).work(by_word, 5, 0)
    assert len({p.split("/")[1] for p in files(place, "done")}) == 2


def test_a_report_that_is_still_being_written_is_left_alone(place, intake):
    place.write("now.txt", b"generated")
    place.write("later.txt.part", b"generated")
    place.write("case/report.txt", b"generated")
    place.write("case/diagram.png.tmp", b"half")
    place.write("letter.docx", b"no report")
    assert intake(place, settle_s=3600).work(by_word, 5, 0) == {"left": 2, "no_report": 2}
    assert files(place, ".inbox") == []


def test_a_report_settles_by_its_date_or_under_our_own_watch_where_clocks_differ(tmp_path, intake):
    place = Place(str(tmp_path / "inbox"))
    for name, shift in (("old.txt", -3600), ("future.txt", 3600)):
        place.write(name, f"generated {name}".encode())
        os.utime(tmp_path / "inbox" / name, (time.time() + shift,) * 2)
    worker = intake(place, settle_s=0.05)
    assert [t.entry.name for t in worker.take(5)] == ["old.txt"]
    deadline = time.monotonic() + 60
    while not (taken := worker.take(5)) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert [t.entry.name for t in taken] == ["future.txt"]


def test_a_report_written_anew_meanwhile_is_another_report(tmp_path, intake):
    place = Place(str(tmp_path / "inbox"))
    place.write("a.txt", b"generated first")

    def slow(cases, ended):
        if "first" in cases[0].source.read_text():
            place.write("a.txt", b"generated second")
        by_word(cases, ended)

    assert intake(place).work(slow, 5, 0) == {"generated": 2}
    assert len(files(place, LEDGER)) == 2


def test_a_report_that_ends_every_worker_is_put_apart(place, intake):
    place.write("bomb.txt", b"generated")
    for _ in range(MAX_TAKES):
        time.sleep(0.002)  # stores tell times in steps
        assert len(intake(place, lease_s=0.001).take(5)) == 1
    time.sleep(0.002)
    assert intake(place, lease_s=0.001).work(by_word, 5, 0) == {"failed": 1}
    assert any("bomb" in p for p in files(place, "failed"))


def test_two_workers_at_once_do_no_report_twice(tmp_path, intake):
    place, done = Place(str(tmp_path / "inbox")), []
    for n in range(60):
        place.write(f"{n}.txt", f"generated {n}".encode())

    def do(cases, ended):
        done.extend(c.id for c in cases)
        by_word(cases, ended)

    with ThreadPoolExecutor(2) as threads:
        counts = list(threads.map(lambda worker: worker.work(do, 4, 60), [intake(place), intake(place)]))
    assert Counter(done).most_common(1)[0][1] == 1
    assert sum(c.get("generated", 0) for c in counts) == len(done) == 60


# ------------------------------------------------------------------ killed at any point
class Killed(BaseException):
    """Nothing of this process happens any more."""


@dataclass(frozen=True)
class Mortal(Place):
    """A place whose worker is killed before its n-th change."""

    budget: list[int] = field(default_factory=lambda: [10**9])

    def _spend(self):
        self.budget[0] -= 1
        if self.budget[0] < 0:
            raise Killed

    def create(self, name, content):
        """Die or do it."""
        self._spend()
        return super().create(name, content)

    def write(self, name, content):
        """Die or do it."""
        self._spend()
        super().write(name, content)

    def remove(self, name):
        """Die or do it."""
        self._spend()
        super().remove(name)

    def move(self, entry, target):
        """Die or do it."""
        self._spend()
        super().move(entry, target)


def test_killed_before_any_change_the_next_worker_finishes_and_nothing_is_lost_or_double(place, intake):
    for changes in range(200):
        inbox = Place(f"{place.address}/{changes}")
        inbox.write("a.txt", b"generated 1")
        inbox.write("copy.txt", b"generated 1")
        inbox.write("case/report.txt", b"refused 2")
        inbox.write("case/diagram.png", b"png")
        killed = False
        try:
            intake(Mortal(inbox.address, budget=[changes])).work(by_word, 5, 0)
        except Killed:
            killed = True
        time.sleep(0.002)
        intake(inbox, lease_s=0.001).work(by_word, 5, 0)
        moved = [Path(p).name for f in ("done", "refused", "failed") for p in files(inbox, f)]
        assert sorted(n for n in moved if n != "outcome.json") == ["a.txt", "copy.txt", "diagram.png", "report.txt"]
        assert len(files(inbox, LEDGER)) == 2, f"killed before change {changes}"
        assert not [e for e in inbox.entries() if e.name not in ("done", "refused")]
        if not killed:
            break
    assert changes > 10
