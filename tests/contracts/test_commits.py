"""Subjects of commits: imperative, at most 72 characters, no full stop. Older commits are left as they are."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SINCE = "2026-11-27T00:00:00Z"
LONGEST = 72
NOT_IMPERATIVE = re.compile(r"^(?!Bring\b)(?:\w+ed|\w+ing|Figures|Tests|Fixes|Adds|Changes)\b|[.]$")


def faults(subject: str) -> list[str]:
    """What is wrong with a subject; empty if nothing is."""
    found = [f"{len(subject)} characters, at most {LONGEST}"] if len(subject) > LONGEST else []
    return found + (["not in the imperative"] if NOT_IMPERATIVE.search(subject) else [])


def test_subjects_of_new_commits_are_short_and_imperative():
    command = ["git", "log", "--no-merges", f"--since={SINCE}", "--format=%s"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        pytest.skip("no history here")
    assert {subject: faults(subject) for subject in done.stdout.splitlines() if faults(subject)} == {}


@pytest.mark.parametrize("subject", ["Read " + "x" * 80, "Added a validator", "Adding a validator", "Read turns."])
def test_a_long_or_descriptive_subject_is_found(subject):
    assert faults(subject)


def test_a_plain_subject_passes():
    assert faults("Read tram and e-scooter as actor kinds") == faults("Bring vehicles back") == []
