"""Kept answers: asked once, written as they come, faults named."""

import json
from pathlib import Path
from threading import Event

import pytest

from research.benchmarks.texts import answer_cache


def test_only_new_ones_are_asked_and_all_are_kept(tmp_path: Path) -> None:
    file, asked = tmp_path / "kept.jsonl", []

    def answer(text: str) -> str:
        asked.append(text)
        return text.upper()

    assert answer_cache.answers({"a": "x"}, answer, "said", file, 2) == {"a": "X"}
    assert answer_cache.answers({"a": "x", "b": "y"}, answer, "said", file, 2) == {"a": "X", "b": "Y"}
    assert asked == ["x", "y"]
    assert [json.loads(line) for line in file.read_text().splitlines()] == [
        {"id": "a", "said": "X"},
        {"id": "b", "said": "Y"},
    ]


def test_what_was_answered_before_a_fault_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "kept.jsonl"

    begun, failed = Event(), Event()

    def answer(text: str) -> str:
        if text == "bad":
            assert begun.wait(10)
            failed.set()
            raise OSError("no connection")
        begun.set()
        assert failed.wait(10)  # this answer comes behind the fault
        return text

    with pytest.raises(OSError, match="no connection"):
        answer_cache.answers({"a": "bad", "b": "good"}, answer, "said", file, 2)
    assert [json.loads(line)["id"] for line in file.read_text().splitlines()] == ["b"]


def test_nobody_is_asked_if_nothing_can_be_kept(tmp_path: Path) -> None:
    asked: list[str] = []
    with pytest.raises(OSError, match="absent"):
        answer_cache.answers({"a": "x"}, asked.append, "said", tmp_path / "absent" / "kept.jsonl", 1)
    assert not asked


def test_a_line_of_another_form_is_named(tmp_path: Path) -> None:
    file = tmp_path / "kept.jsonl"
    file.write_text('{"id": "a", "said": 1}\n{"id": "b"}\n')
    with pytest.raises(ValueError, match=r"kept\.jsonl, line 2: .*'said'.*delete the line"):
        answer_cache.answers({}, str, "said", file, 1)


def test_without_a_file_nothing_is_kept() -> None:
    assert answer_cache.answers({"a": 1}, str, "said", None, 1) == {"a": "1"}
