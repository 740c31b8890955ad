"""Entries of a folder of cases: each is a case, or named as left out."""

import os

import pytest

from flows.case_files.find_cases import cases_in
from flows.case_files.folder_cases import (
    FEW,
    LEFT_OUT,
    left_out,
    left_out_line,
    read_left_out,
    write_left_out,
)


@pytest.fixture
def mixed(tmp_path):
    (folder := tmp_path / "cases").mkdir()
    for name in ("b", "a", ".hidden"):
        (folder / name).mkdir()
    for name in ("README.txt", "LICENSE", "loose.txt", "scan.PDF", "coded.xml", "notes.docx", ".DS_Store", "index.xml"):
        (folder / name).write_text("x")
    (folder / "gone.txt").symlink_to(folder / "nowhere")
    return folder


def test_every_visible_entry_is_a_case_or_named(mixed):
    assert [case.id for case in cases_in([mixed])] == ["a", "b", "coded", "loose", "scan"]
    left = [f"cases/{name}" for name in ("LICENSE", "README.txt", "gone.txt", "index.xml", "notes.docx")]
    assert list(left_out([mixed])) == left


def test_facts_beside_a_loose_report_are_a_part_of_it(mixed):
    before = left_out([mixed])
    (mixed / "loose.txt.facts.yaml").write_text("edits: []\n")
    assert left_out([mixed]) == before
    (mixed / "other.txt.facts.yaml").write_text("edits: []\n")  # its report is gone
    assert set(left_out([mixed])) - set(before) == {"cases/other.txt.facts.yaml"}


def test_many_loose_reports_beside_one_folder_are_cases(tmp_path):
    (tmp_path / "a").mkdir()
    for number in range(115):
        (tmp_path / f"r{number}.txt").write_text("x")
    assert len(cases_in([tmp_path])) == 116
    assert left_out([tmp_path]) == ()


def test_a_folder_and_a_file_of_one_name_are_two_cases(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a.txt").write_text("x")
    assert [case.id for case in cases_in([tmp_path])] == ["a", "a.txt"]


def test_case_folders_beside_a_report_are_named(tmp_path):
    for name in ("one", "two", "pictures"):
        (tmp_path / name).mkdir()
    for name in ("one", "two"):
        (tmp_path / name / "report.txt").write_text("x")
    (tmp_path / "report.txt").write_text("x")
    assert [case.source for case in cases_in([tmp_path])] == [tmp_path]
    assert left_out([tmp_path]) == (f"{tmp_path.name}/one", f"{tmp_path.name}/two")


def test_the_line_counts_and_names_the_first():
    assert left_out_line(()) == ""
    names = [f"cases/{number}.docx" for number in range(FEW + 2)]
    assert left_out_line(names).startswith(f"left out, {FEW + 2} beside the cases: cases/0.docx, ")
    assert " and 2 more; " in left_out_line(names)
    assert (
        left_out_line([f"cases/{os.fsdecode(b'x' + bytes([255]))}"])
        .encode()
        .endswith(rb"cases/x\udcff; a case is a folder or .pdf, .txt, .xml")
    )


def test_results_keep_what_was_left_out(tmp_path):
    names = ("cases/notes.docx", "cases/" + os.fsdecode(b"\xff.doc"))
    write_left_out(tmp_path, names)
    assert read_left_out(tmp_path) == names
    write_left_out(tmp_path, ())
    assert not (tmp_path / LEFT_OUT).exists()
    assert read_left_out(tmp_path) == ()


@pytest.mark.parametrize("content", ["[]", "7", "{", '{"left_out": 7}', "[" * 90_000])
def test_a_note_of_another_kind_is_none(tmp_path, content):
    (tmp_path / LEFT_OUT).write_text(content)
    assert read_left_out(tmp_path) == ()
