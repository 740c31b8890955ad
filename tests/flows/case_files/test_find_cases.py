"""Case ids, folders of cases, and what makes a finished case stale."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from flows.case_files import find_cases
from flows.case_files.find_cases import Case, cases_in, cases_of, digest_of, safe_id
from plugins.report_reader.folder import Folder
from sgcad_core.config import load
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.system.report_files import MAX_FILES


@pytest.mark.parametrize("name", ["2005-12-345678901", "ciren-100271", "case 7 (b)", "report.txt", "Köln", "a_b.c"])
def test_an_ordinary_name_is_kept_unchanged(name):
    assert safe_id(name) == name


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("../../etc/passwd", "__.._etc_passwd"),
        ("..", "_"),
        (".hidden", "_hidden"),
        ("a\nb\x00c", "a_b_c"),
        ("", "case"),
        ("a:b\\c", "a_b_c"),
    ],
)
def test_a_dangerous_name_is_made_safe(name, safe):
    assert safe_id(name) == safe


@given(st.text(max_size=300))
@hypothesis_settings(max_examples=300, deadline=None)
def test_any_name_becomes_one_plain_visible_folder_name(name):
    safe = safe_id(name)
    assert safe
    assert Path(safe).name == safe
    assert safe not in (".", "..")
    assert not safe.startswith(".")
    assert len(safe.encode()) <= 120
    assert "\x00" not in safe
    assert "\n" not in safe


def test_long_names_that_differ_at_their_end_stay_apart():
    assert safe_id("x" * 300 + "1") != safe_id("x" * 300 + "2")


def test_a_folder_of_loose_reports_is_a_folder_of_cases(tmp_path):
    for name in ("one.txt", "two.xml", "three.pdf", "notes.docx"):
        (tmp_path / name).write_text("x")
    assert [c.id for c in cases_in([tmp_path])] == ["one", "three", "two"]


def test_files_of_one_name_keep_their_suffixes(tmp_path):
    for name in ("one.txt", "one.xml", "two.pdf"):
        (tmp_path / name).write_text("x")
    assert [c.id for c in cases_in([tmp_path])] == ["one.txt", "one.xml", "two"]


def test_a_folder_that_nobody_may_look_into_costs_its_own_case(tmp_path, monkeypatch):
    from flows.case_files import find_cases

    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    listed = Path.rglob

    def closed(self, pattern):
        if self.name == "b":
            raise PermissionError(13, "Permission denied", str(self))
        return listed(self, pattern)

    monkeypatch.setattr(Path, "rglob", closed)
    digests = {find_cases.source_digest(tmp_path / name) for name in ("a", "b")}
    assert len(digests) == 2


def test_a_case_folder_itself_is_one_case(reports):
    assert [c.id for c in cases_in([reports(c1="") / "c1"])] == ["c1"]


def test_a_folder_named_by_dots_is_called_by_its_real_name(reports, monkeypatch):
    monkeypatch.chdir(reports(c1="") / "c1")
    assert [c.id for c in cases_of([Path()])] == ["c1"]


def test_two_reports_of_one_name_are_refused(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "report.txt").write_text("x")
    with pytest.raises(ConfigError, match=r"a/report.txt and .*b/report.txt would share the folder 'report.txt'"):
        cases_of([tmp_path / "a" / "report.txt", tmp_path / "b" / "report.txt"])


def test_a_missing_report_is_named(tmp_path):
    with pytest.raises(ConfigError, match=r"no such report: .*/nowhere; give a case folder"):
        cases_of([tmp_path / "nowhere"])


def test_an_empty_folder_and_a_missing_one_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="it contains no case; put each report into a folder of its own"):
        cases_in([tmp_path])
    with pytest.raises(ConfigError, match="no such folder"):
        cases_in([tmp_path / "nowhere"])


def digest(folder, file, *overrides):
    return digest_of(Case(folder, folder.name), load(file, overrides))


def test_the_same_report_and_config_have_the_same_digest(reports, config_file):
    folder, file = reports(c1="") / "c1", config_file()
    assert digest(folder, file) == digest(folder, file)


def test_a_changed_report_config_or_diagram_changes_the_digest(reports, config_file):
    folder, file = reports(c1="") / "c1", config_file()
    seen = {digest(folder, file), digest(folder, file, "seed=7"), digest(folder, file, "simulator.fails=true")}
    (folder / "diagram.png").write_bytes(b"png")
    seen.add(digest(folder, file))
    (folder / "report.txt").write_text("another text")
    seen.add(digest(folder, file))
    assert len(seen) == 5


def test_another_tracker_does_not_make_a_case_stale(reports, config_file, tmp_path):
    folder, file = reports(c1="") / "c1", config_file()
    assert digest(folder, file) == digest(folder, file, "tracker=jsonl")


def test_a_raised_plugin_version_changes_the_digest(reports, config_file, monkeypatch):
    folder, file = reports(c1="") / "c1", config_file()
    before = digest(folder, file)
    import sgcad_testkit

    monkeypatch.setattr(sgcad_testkit.KitRoad, "version", "2")
    assert digest(folder, file) != before


def test_an_edited_wording_counts_as_edited_code():
    wordings = find_cases.settings.ROOT / "sgcad_core/reading/language/rules/clauses.yaml"
    assert wordings in find_cases._sources(find_cases.settings.ROOT / "sgcad_core")


def test_a_changed_script_of_answers_changes_the_digest(reports, config_file, tmp_path):
    folder, script = reports(c1="") / "c1", tmp_path / "answers.yaml"
    script.write_text("- hello")
    file = config_file(backbone={"name": "scripted", "file": str(script)}, decoder="greedy")
    before = digest(folder, file)
    script.write_text("- goodbye")
    assert digest(folder, file) != before


@pytest.mark.parametrize("limit", [2**20, 0], ids=["by content", "by size"])
def test_other_weights_in_the_same_folder_change_the_digest(reports, config_file, tmp_path, monkeypatch, limit):
    monkeypatch.setattr("flows.case_files.find_cases.MAX_READ_BYTES", limit)
    folder, weights = reports(c1="") / "c1", tmp_path / "weights"
    weights.mkdir()
    (weights / "model.safetensors").write_bytes(b"1234")
    file = config_file(backbone={"name": "hf_vision", "model": str(weights)}, decoder="greedy")
    before = digest(folder, file)
    assert digest(folder, file) == before
    (weights / "model.safetensors").write_bytes(b"12345")
    assert digest(folder, file) != before


@pytest.mark.parametrize(("config", "counts"), [("template.yaml", True), ("fused.yaml", True), ("mini.yaml", False)])
def test_changed_code_changes_results_unless_a_model_writes_them(monkeypatch, config, counts):
    digests = set()
    for code in ("before", "after"):
        monkeypatch.setattr(find_cases, "_code_digest", lambda code=code: code)
        digests.add(find_cases.config_digest(load(config)))
    assert (len(digests) == 2) is counts


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_an_unreadable_report_has_a_digest(reports, config_file):
    folder = reports(c1="") / "c1"
    (folder / "report.txt").chmod(0)
    assert digest(folder, config_file())


def test_a_folder_of_a_whole_disk_is_neither_hashed_nor_read(tmp_path, config_file):
    (tmp_path / "home").mkdir()
    for number in range(MAX_FILES + 1):
        (tmp_path / "home" / f"{number}.dat").touch()
    (tmp_path / "home" / "report.txt").write_text("Vehicle #1 struck Vehicle #2.", encoding="utf-8")
    (tmp_path / "case").symlink_to(tmp_path / "home")
    assert digest(tmp_path / "case", config_file())
    with pytest.raises(BadInput, match="more than 1000 files and folders in it: give the folder of one report"):
        Folder().read(tmp_path / "case")


def test_a_file_larger_than_any_report_is_not_hashed(tmp_path, config_file):
    (tmp_path / "case").mkdir()
    with (tmp_path / "case" / "report.txt").open("wb") as sparse:
        sparse.truncate(200 * 2**30)
    assert digest(tmp_path / "case", config_file())


def test_an_index_built_anew_changes_the_digest_and_a_missing_one_is_said_at_once(reports, config_file, tmp_path):
    from plugins.retriever.knowledge.manifest import MANIFEST, Manifest

    folder, index = reports(c1="") / "c1", tmp_path / "index"
    file = config_file(retriever={"name": "lancedb", "folder": str(index)})
    with pytest.raises(ConfigError, match="sgcad index build"):
        digest(folder, file)
    about = {"embedder": "", "dimension": 0, "chunks": 1, "kinds": {}, "sources": {}, "written": "now"}
    index.mkdir()
    seen = set()
    for number, content in ((1, "aaaa"), (2, "bbbb")):
        made = Manifest(number=number, tag=f"kb-v{number}", content=content, table_version=number, **about)
        (index / MANIFEST).write_text(made.model_dump_json())
        seen.add(find_cases.config_digest(load(file)))
        seen.add(find_cases.config_digest(load(file)))
    assert len(seen) == 2
