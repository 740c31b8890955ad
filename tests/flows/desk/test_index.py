"""The index: finds cases at every depth, follows the disk, and survives whatever lies there."""

import json
import os
import shutil
import time

import pytest

from flows.desk.index import Index
from tests.flows.desk.conftest import foreign


def keys(index):
    time.sleep(0.31)  # within FRESH_S the folder is not looked through again
    return sorted(index.listing(5).rows)


def test_cases_are_found_in_configs_studies_and_a_configs_own_folder(tmp_path):
    for place in ("template", "demo/template", "studies/kit/arm"):
        foreign(tmp_path / place, "c1")
    foreign(tmp_path / "mlflow-artifacts" / "0", "artifacts")
    foreign(tmp_path / "template", ".partial-1-x")
    assert keys(Index(tmp_path)) == ["demo/template/c1", "studies/kit/arm/c1", "template/c1"]
    assert keys(Index(tmp_path / "template")) == ["c1"]


def test_the_index_follows_what_happens_on_disk(tmp_path):
    index = Index(tmp_path)
    assert keys(index) == []
    place = foreign(tmp_path / "kit", "a")
    assert keys(index) == ["kit/a"]
    (place / "result.json").write_text(json.dumps({"status": "refused", "reason": "none"}))
    time.sleep(0.31)
    assert index.listing(5).rows["kit/a"].status == "refused"
    shutil.rmtree(place)
    assert keys(index) == []


@pytest.mark.parametrize("content", ["", '{"status": "gen', "[1, 2]", "null", '{"no": 1}',
                                     '{"status": "generated", "facts": 3}',
                                     '{"status": "generated", "facts": [{}]}', "[" * 100_000])  # fmt: skip
def test_a_half_written_or_foreign_result_is_a_row_that_says_so(tmp_path, content):
    (foreign(tmp_path / "kit", "a") / "result.json").write_text(content)
    row = Index(tmp_path).listing(5).rows["kit/a"]
    assert (row.status, row.trust) == ("unreadable", "broken")
    assert "run the case again" in row.reason


def test_no_key_leads_out_of_the_folder(tmp_path):
    foreign(tmp_path / "out", "secret")
    root = tmp_path / "runs"
    foreign(root / "kit", "a")
    (root / "kit" / "link").symlink_to(tmp_path / "out" / "secret")
    index = Index(root)
    for key in (
        "../out/secret",
        "kit/../../out/secret",
        "/etc",
        "kit//a",
        "",
        ".",
        "kit/link",
        "kit/a\0",
        ".hidden/x",
        "a/b/c/d/e",
    ):
        assert index.row(key) is None, key
    assert keys(index) == ["kit/a"]
    assert index.row("kit/a").case == "a"


def test_a_page_gets_what_is_known_and_how_much_is_to_come(tmp_path):
    for k in range(400):
        foreign(tmp_path / "kit", f"c{k}")
    index = Index(tmp_path)
    first = index.listing(0)
    assert len(first.rows) + first.pending <= 400
    deadline = time.monotonic() + 20
    while (now := index.listing(0.2)).pending or len(now.rows) < 400:
        assert time.monotonic() < deadline
    assert len(now.rows) == 400


def test_names_that_no_address_can_carry_are_passed_over(tmp_path):
    foreign(tmp_path / "kit", "ünïcode näme & <b>")
    os.mkdir(os.fsencode(tmp_path / "kit") + b"/bad\xff")
    assert keys(Index(tmp_path)) == ["kit/ünïcode näme & <b>"]
