"""Facts and results change together, also where the process dies between both."""

import json
import os
import signal
import subprocess
import sys

import pytest

from flows.case.facts_journal import both_or_neither, journal_of, settle, settled
from sgcad_core.revision.file import facts_lock
from sgcad_core.system.report_files import files_below
from tests.effort import spread

DYING = """
import os, signal, sys
from pathlib import Path
from flows.case.facts_journal import both_or_neither
facts, folder, when = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
with both_or_neither(facts, folder):
    facts.write_text("new")
    if when == "between":
        os.kill(os.getpid(), signal.SIGKILL)
    (folder / "result.json").unlink()
    (folder / "result.json").write_text("new result")
    if when == "behind":
        os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "report").mkdir()
    (tmp_path / "report" / "report.txt").write_text("text")
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "result.json").write_text("old")
    return tmp_path


def facts_of(place):
    return place / "report" / "facts.yaml"


def die(place, when):
    command = [sys.executable, "-c", DYING, str(facts_of(place)), str(place / "runs"), when]
    assert subprocess.run(command).returncode == (-signal.SIGKILL if when else 0)


ENDS = [
    (when, kept, before)
    for when, kept in (("between", False), ("behind", True), ("", True))
    for before in (None, "old facts")
]


@pytest.mark.parametrize(("when", "kept", "before"), spread(ENDS, 3))
def test_a_killed_writer_leaves_both_or_neither(place, when, kept, before):
    if before:
        facts_of(place).write_text(before)
    die(place, when)
    settled(place / "report")
    told = facts_of(place).read_text() if facts_of(place).exists() else None
    assert told == ("new" if kept else before)
    assert not journal_of(facts_of(place)).exists()


def test_a_fault_of_the_writer_takes_the_facts_back(place):
    def write_and_fail():
        with both_or_neither(facts_of(place), place / "runs"):
            facts_of(place).write_text("new")
            raise KeyError("x")

    facts_of(place).write_text("old facts")
    with pytest.raises(KeyError, match="x"):
        write_and_fail()
    assert facts_of(place).read_text() == "old facts"


def test_facts_at_which_another_process_works_are_left_alone(place):
    die(place, "between")
    with facts_lock(place / "report"):
        settled(place / "report")  # the lock is held: by this very process, which counts as well
        assert journal_of(facts_of(place)).exists()
    settled(place / "report")
    assert not facts_of(place).exists()


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"folder": 1, "version": "", "facts": ""}', "[" * 90_000])
def test_a_journal_of_no_use_is_removed(place, content):
    facts_of(place).write_text("facts")
    journal_of(facts_of(place)).write_text(content)
    assert settle(facts_of(place)) is False
    assert facts_of(place).read_text() == "facts"
    assert not journal_of(facts_of(place)).exists()


def test_a_journal_is_no_file_of_the_report(place):
    journal_of(facts_of(place)).write_text("{}")
    assert [file.name for file in files_below(place / "report")] == ["report.txt"]


def test_a_full_disk_leaves_no_piece(place, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(Exception, match="cannot be written"), both_or_neither(facts_of(place), place / "runs"):
        pass
    assert os.listdir(place / "report") == ["report.txt"]
    assert json.dumps(sorted(os.listdir(place / "runs"))) == '["result.json"]'
