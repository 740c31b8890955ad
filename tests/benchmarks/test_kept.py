"""Kept answers: asked once, written as they come, faults named."""

import json
from pathlib import Path

import pytest

from benchmarks import kept


def test_only_new_ones_are_asked_and_all_are_kept(tmp_path: Path) -> None:
    file, asked = tmp_path / "kept.jsonl", []

    def answer(text: str) -> str:
        asked.append(text)
        return text.upper()

    assert kept.answers({"a": "x"}, answer, "said", file, 2) == {"a": "X"}
    assert kept.answers({"a": "x", "b": "y"}, answer, "said", file, 2) == {"a": "X", "b": "Y"}
    assert asked == ["x", "y"]
    assert [json.loads(line) for line in file.read_text().splitlines()] == [
        {"id": "a", "said": "X"},
        {"id": "b", "said": "Y"},
    ]


def test_what_was_answered_before_a_fault_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "kept.jsonl"

    def answer(text: str) -> str:
        if text == "bad":
            raise OSError("no connection")
        return text

    with pytest.raises(OSError, match="no connection"):
        kept.answers({"a": "good", "b": "bad"}, answer, "said", file, 1)
    assert [json.loads(line)["id"] for line in file.read_text().splitlines()] == ["a"]


def test_a_line_of_another_form_is_named(tmp_path: Path) -> None:
    file = tmp_path / "kept.jsonl"
    file.write_text('{"id": "a", "said": 1}\n{"id": "b"}\n')
    with pytest.raises(ValueError, match=r"kept\.jsonl, line 2: .*'said'.*delete the line"):
        kept.answers({}, str, "said", file, 1)


def test_without_a_file_nothing_is_kept() -> None:
    assert kept.answers({"a": 1}, str, "said", None, 1) == {"a": "1"}
