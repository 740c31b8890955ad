"""Coded narratives as rows for the encoder: questions beside tokens, and what the files keep."""

from __future__ import annotations

from pathlib import Path

from research.rows import narrative_rows
from research.rows.narrative_rows import case_of
from tests.research.training.readers.test_train_numbered_reader import line


def test_a_case_has_its_questions_and_comes_back_from_its_files(tmp_path: Path) -> None:
    cases = [case for n in range(3) if (case := case_of(line(f"ciss-{n}", blind=n == 2)))]
    assert [case.part == "blind" for case in cases] == [False, False, True]
    narrative_rows.save(cases, tmp_path / "rows.npz")
    again = narrative_rows.load(tmp_path / "rows.npz")
    assert [case.told.codes.tolist() for case in again] == [case.told.codes.tolist() for case in cases]
    assert [case.told.subjects.tolist() for case in again] == [case.told.subjects.tolist() for case in cases]
    assert [[row.field for row in case.rows] for case in again] == [[row.field for row in case.rows] for case in cases]


def test_files_hold_no_word_of_a_text(tmp_path: Path) -> None:
    case = case_of(line())
    assert case is not None
    narrative_rows.save([case], tmp_path / "rows.npz")
    kept = b"".join(file.read_bytes() for file in tmp_path.iterdir())
    assert b"traveling" not in kept
    assert b"struck" not in kept


def test_a_line_of_which_nothing_is_coded_is_no_case() -> None:
    nothing = {
        "intersections": None,
        "told": {"intersection": False},
        "relative_heading_v2_minus_v1": None,
        "roads": [],
    }
    assert case_of(line(network=nothing, vehicles=[], events=[])) is None
