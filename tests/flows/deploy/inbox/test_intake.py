"""The inbox: every report done once and put where it belongs, whenever the process dies."""

import json
import os
import time
import uuid
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from flows.deploy.inbox import intake as intake_module
from flows.deploy.inbox.intake import LEDGER, MAX_TRIES, TRIES, Intake
from flows.deploy.storage import Place


@pytest.fixture(params=["local", "memory"])
def place(request, tmp_path):
    """An inbox on local files, and one on a store without renames."""
    if request.param == "local":
        return Place(str(tmp_path / "inbox"))
    return Place(f"memory://{uuid.uuid4().hex}")


@pytest.fixture
def intake(tmp_path):
    """Makes a process's view of an inbox."""
    return lambda place, settle_s=0.0: Intake(place, tmp_path / uuid.uuid4().hex, settle_s)


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
    counts = intake(place).work(by_word)
    assert counts == {"generated": 1, "refused": 1, "failed": 1, "exhausted": 1}
    moved = [p for folder in ("done", "refused", "failed") for p in files(place, folder)]
    assert [Path(p).name for p in moved if not p.endswith("outcome.json")] == [
        "a.txt", "b.txt", "c.txt", "diagram.png", "report.txt",
    ]  # fmt: skip
    outcome = json.loads(place.read(next(p for p in files(place, "refused") if p.endswith("outcome.json"))))
    assert outcome["missing"] == ["lanes"]
    assert [e.name for e in place.entries()] == ["done", "failed", "refused"]
    assert files(place, TRIES) == []


def test_what_nobody_reads_is_put_apart_with_the_reason(place, intake):
    place.write("letter.docx", b"word")
    place.write("noise", b"?")
    place.write("half.docx.part", b"wo")
    place.write("case.part/report.txt", b"generated")
    assert intake(place).work(by_word) == {"unread": 2, "no_report": 2}
    assert [Path(p).name for p in files(place, "unread") if not p.endswith("outcome.json")] == ["letter.docx", "noise"]
    outcome = json.loads(place.read("unread/letter.docx/outcome.json"))
    assert outcome["status"] == "unread"
    assert "letter.docx cannot be read (.docx): give .pdf, .txt, .xml, or a folder" in outcome["reason"]
    assert intake(place).work(by_word) == {"no_report": 2}


def test_an_outcome_points_to_its_result(tmp_path):
    def do(cases, ended):
        for case in cases:
            ended(case, {"status": "generated", "reason": "", "missing": [], "config": "template-seed_4"})

    place = Place(str(tmp_path / "inbox"))
    place.write("a.txt", b"text")
    Intake(place, tmp_path / "staging", 0, "template.yaml", tmp_path / "runs").work(do)
    (outcome,) = (tmp_path / "inbox" / "done").glob("*/outcome.json")
    told = json.loads(outcome.read_text())
    assert told["result"] == str(tmp_path / "runs" / "template-seed_4" / told["case"])


def test_the_same_report_twice_is_done_once_whatever_it_is_called(place, intake):
    done = []

    def do(cases, ended):
        done.extend(c.id for c in cases)
        by_word(cases, ended)

    place.write("a.txt", b"generated")
    place.write("b.txt", b"generated")
    assert intake(place).work(do) == {"generated": 1, "again": 1}
    place.write("a.txt", b"generated")
    assert intake(place).work(do) == {"again": 1}
    assert len(done) == len(files(place, LEDGER)) == 1


def test_a_failed_report_may_be_dropped_again(place, intake):
    for _ in range(2):
        place.write("a.txt", b"failed")
        assert intake(place).work(by_word) == {"failed": 1}


def test_two_reports_of_one_name_are_two_cases(place, intake):
    for text in (b"generated 1", b"generated 2"):
        place.write("report.txt", text)
        intake(place).work(by_word)
    assert len({p.split("/")[1] for p in files(place, "done")}) == 2


def test_a_report_that_is_still_being_written_is_left_alone(place, intake):
    place.write("now.txt", b"generated")
    place.write("later.txt.part", b"generated")
    place.write("case/report.txt", b"generated")
    place.write("case/diagram.png.tmp", b"half")
    place.write("letter.docx", b"no report")
    assert intake(place, settle_s=3600).work(by_word) == {"left": 2, "no_report": 2}
    assert files(place, ".inbox") == []


def test_a_report_settles_by_its_date_or_under_our_own_watch_where_clocks_differ(tmp_path, intake):
    place = Place(str(tmp_path / "inbox"))
    for name, shift in (("old.txt", -3600), ("future.txt", 3600)):
        place.write(name, f"generated {name}".encode())
        os.utime(tmp_path / "inbox" / name, (time.time() + shift,) * 2)
    ran = []

    def do(cases, ended):
        ran.append([c.id.split("-")[0] for c in cases])
        by_word(cases, ended)

    assert intake(place, settle_s=0.05).work(do) == {"generated": 2}
    assert ran == [["old"], ["future"]]


def test_a_report_written_anew_meanwhile_is_another_report(tmp_path, intake):
    place = Place(str(tmp_path / "inbox"))
    place.write("a.txt", b"generated first")

    def slow(cases, ended):
        if "first" in cases[0].source.read_text():
            place.write("a.txt", b"generated second")
        by_word(cases, ended)

    assert intake(place).work(slow) == {"generated": 2}
    assert len(files(place, LEDGER)) == 2


class Killed(BaseException):
    """Nothing of this process happens any more."""


def killing(place, digests):
    """Runs cases until "bomb" comes; then the process is killed, which leaves its tries."""

    def do(cases, ended):
        digests.append(sorted(c.id.split("-")[0] for c in cases))
        if any("bomb" in c.id for c in cases):
            raise Killed
        by_word(cases, ended)

    return do


def test_a_report_that_kills_every_process_runs_alone_and_is_put_apart(place, intake, monkeypatch):
    place.write("bomb.txt", b"generated bomb")
    for n in range(3):
        place.write(f"r{n}.txt", f"generated {n}".encode())
    monkeypatch.setattr(Place, "remove", lambda self, name: None)  # a killed process removes nothing
    ran = []
    for _ in range(MAX_TRIES):
        with pytest.raises(Killed):
            intake(place).work(killing(place, ran))
    assert ran == [["bomb", "r0", "r1", "r2"], ["bomb"], ["bomb"]]
    monkeypatch.undo()
    assert intake(place).work(killing(place, ran)) == {"failed": 1, "generated": 3}
    assert ran[3:] == [["r0"], ["r1"], ["r2"]]
    (outcome,) = (p for p in files(place, "failed") if p.endswith("outcome.json"))
    assert "killed 3 times" in json.loads(place.read(outcome))["reason"]
    assert files(place, TRIES) == []


def test_an_interrupted_run_suspects_no_report(place, intake):
    place.write("a.txt", b"generated 1")

    def interrupted(cases, ended):
        assert place.read(files(place, TRIES)[0]) == b"1"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        intake(place).work(interrupted)
    assert files(place, TRIES) == []
    assert intake(place).work(by_word) == {"generated": 1}


def test_of_many_reports_those_that_come_first_are_under_suspicion(place, intake):
    tried = []
    for n in range(12):
        place.write(f"r{n:02d}.txt", f"generated {n}".encode())

    def do(cases, ended):
        tried.append(len(files(place, TRIES)))
        for case in cases:
            by_word([case], ended)
            tried.append(len(files(place, TRIES)))

    assert intake(place).work(do) == {"generated": 12}
    assert tried == [8] * 5 + [7, 6, 5, 4, 3, 2, 1, 0]


def test_reports_run_in_portions(place, intake, monkeypatch):
    monkeypatch.setattr(intake_module, "PORTION", 2)
    sizes = []
    for n in range(5):
        place.write(f"{n}.txt", f"generated {n}".encode())

    def do(cases, ended):
        sizes.append(len(cases))
        by_word(cases, ended)

    assert intake(place).work(do) == {"generated": 5}
    assert sizes == [2, 2, 1]


# ------------------------------------------------------------------ faults cost one report
ODD = [b"no-utf-8-\xff.txt", b"two\nlines.txt", b"x" * 251 + b".txt", b"[*] ?#%41.txt", b"no-utf-8-\xff.docx", b"~.pdf"]


def test_a_report_of_any_name_is_handed_in_and_its_name_is_kept(tmp_path, intake):
    (tmp_path / "inbox").mkdir()
    for number, name in enumerate(ODD):
        (tmp_path / "inbox" / os.fsdecode(name)).write_bytes(f"generated {number}".encode())
    assert intake(Place(str(tmp_path / "inbox"))).work(by_word) == {"unread": 1, "generated": 5}
    outcomes = [json.loads(f.read_bytes()) for f in (tmp_path / "inbox").glob("*/*/outcome.json")]
    assert sorted(os.fsencode(o["name"]) for o in outcomes) == sorted(ODD)
    moved = [f for f in (tmp_path / "inbox").glob("[du]*/*/*") if f.name != "outcome.json"]
    assert sorted(os.fsencode(f.name) for f in moved) == sorted(ODD)


def test_a_folder_with_odd_names_inside_is_one_report(tmp_path, intake):
    folder = tmp_path / "inbox" / os.fsdecode(b"case\xfe")
    folder.mkdir(parents=True)
    (folder / "report.txt").write_text("generated")
    (folder / os.fsdecode(b"photo\n\xff.png")).write_bytes(b"png")
    assert intake(Place(str(tmp_path / "inbox"))).work(by_word) == {"generated": 1}


@dataclass(frozen=True)
class Faulty(Place):
    """A place that refuses to move the report b.txt, or to write anything of it."""

    unwritten: bool = False

    def move(self, entry, target):
        """Refuse or do it."""
        if entry.name == "b.txt":
            raise PermissionError(f"{entry.name} is held")
        super().move(entry, target)

    def write(self, name, content):
        """Refuse or do it."""
        if self.unwritten and name.startswith("failed/b.txt"):
            raise OSError("no room")
        super().write(name, content)


@pytest.mark.parametrize("unwritten", [False, True])
def test_a_report_that_cannot_be_moved_costs_itself_and_says_why(tmp_path, intake, unwritten):
    place, log = Faulty(str(tmp_path / "inbox"), unwritten=unwritten), []
    for name in "abc":
        place.write(f"{name}.txt", f"generated {name}".encode())
    worker = intake(place)
    worker.tell = log.append
    assert worker.work(by_word) == {"generated": 2, "stuck": 1}
    assert "b.txt stays in the inbox: PermissionError: b.txt is held" in log[0]
    if unwritten:
        assert "outcome.json cannot be written either" in log[1]
    else:
        assert "b.txt is held" in json.loads(place.read("failed/b.txt/outcome.json"))["reason"]
    assert files(place, TRIES) == []
    assert intake(Place(place.address)).work(by_word) == {"again": 1}  # once it can be moved


# ------------------------------------------------------------------ killed at any point
@dataclass(frozen=True)
class Mortal(Place):
    """A place whose worker is killed before its n-th change."""

    budget: list[int] = field(default_factory=lambda: [10**9])

    def _spend(self):
        self.budget[0] -= 1
        if self.budget[0] < 0:
            raise Killed

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
            intake(Mortal(inbox.address, budget=[changes])).work(by_word)
        except Killed:
            killed = True
        intake(inbox).work(by_word)
        moved = [Path(p).name for f in ("done", "refused", "failed") for p in files(inbox, f)]
        assert sorted(n for n in moved if n != "outcome.json") == ["a.txt", "copy.txt", "diagram.png", "report.txt"]
        assert len(files(inbox, LEDGER)) == 2, f"killed before change {changes}"
        assert not [e for e in inbox.entries() if e.name not in ("done", "refused")]
        if not killed:
            break
    assert changes > 10


def test_a_damaged_ledger_costs_its_report_alone(place, intake):
    """A fault of any type, here an entry of the ledger that is no object."""
    place.write("a.txt", b"generated 1")
    assert intake(place).work(by_word) == {"generated": 1}
    for entry in files(place, LEDGER):
        place.write(entry, b"[]")
    place.write("again.txt", b"generated 1")
    place.write("new.txt", b"generated 3")
    assert intake(place).work(by_word) == {"generated": 1, "stuck": 1}
