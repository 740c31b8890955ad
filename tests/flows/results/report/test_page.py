"""The page: self-contained, harmless whatever a report says, and its gallery sorts and filters."""

import json
import re
import shutil
import subprocess

import pytest
from typer.testing import CliRunner

from flows.cli import app
from flows.results.report.page import page
from flows.results.report.plots import Plot
from tests.flows.desk.browser import walking

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
EVIL = (
    "</script><script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\"> %DATA% /*SCRIPT*/"
)


def data_of(text):
    (block,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    return json.loads(block)


def made(tables, tmp_path, *args, **more):
    return page(
        tables(*args, **more),
        [Plot("x", "A figure", "c", reason="nothing")],
        tmp_path / "runs" / "studies" / "kit" / "r.html",
    )


def test_the_page_asks_the_network_for_nothing(tables, tmp_path):
    text = made(tables, tmp_path, {"a": {"c1": {}}})
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert not re.findall(r"https?://|@import|fetch\(", text)
    assert "default-src 'none'" in text


def test_nothing_in_a_report_a_label_or_a_reason_becomes_markup(tables, tmp_path):
    text = made(
        tables, tmp_path, {"a": {"c1": {"story": EVIL}, "c2": {"status": "refused"}}},
        about={"title": EVIL, "hardware": {"<b>": "<i>"}}, arms={"a": {"label": EVIL}},
    )  # fmt: skip
    assert text.count("</script>") == 2
    assert "<img src=x" not in text
    assert "<b>:" not in text
    assert data_of(text)["cases"][0]["text"] == EVIL
    assert data_of(text)["arms"][0]["label"] == EVIL


def test_the_gallery_holds_what_a_case_came_to(tables, tmp_path):
    text = made(tables, tmp_path, {"a": {"c1": {}, "c 2": {"status": "refused"}}, "b": {"c1": {"realised": False}}})
    cases = data_of(text)["cases"]
    assert [c["id"] for c in cases] == ["c1", "c 2"]
    first, second = cases[0]["arms"]
    assert (first["status"], first["declared"], second["declared"]) == ("generated", True, False)
    assert first["player"] == "a/c1/player.html"
    right = dict(zip(data_of(text)["verdicts"], first["right"], strict=True))
    assert right["intersections"] == right["contact pair"] == right["sides"] == 1
    assert right["lanes total"] is None
    assert cases[1]["arms"] == [cases[1]["arms"][0], None]
    assert "refused for a reason" in cases[1]["arms"][0]["why"]
    assert [m["id"] for m in first["draw"]["movers"]] == ["V1", "V2"]
    assert len(first["draw"]["lanes"]) == 6


def test_each_sentence_of_the_report_is_marked_as_it_was_read(tables, tmp_path):
    text = made(tables, tmp_path, {"a": {"c1": {"marked": True}}})
    (case,) = data_of(text)["cases"]
    assert {case["text"][a:b]: mark for a, b, mark in case["told"]} == {
        "V1 was traveling east on a two-lane road.": "read", "V2 was stopped ahead.": "contradicts",
        "The front of V1 struck the rear of V2.": "unread",
    }  # fmt: skip
    assert data_of(text)["marked"]["unread"] == "not read"


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to look with")
def test_the_page_can_be_read_in_the_light_and_in_the_dark(tables, tmp_path):
    cases = {"c1": {}, "c2": {"status": "refused"}, "c3": {"status": "failed"}, "c4": {"status": "exhausted"}}
    file = tmp_path / "r.html"
    file.write_text(made(tables, tmp_path, {"a": cases, "b": {"c1": {"realised": False}}}))
    with walking(CHROMIUM) as walker:
        for theme in ("light", "dark"):
            walker.theme(theme)
            walker.open(f"file://{file}?{theme}")
            walker.until("document.querySelectorAll('.tile').length >= 5")
            assert walker.poor() == []
            assert walker.run("getComputedStyle(document.documentElement).colorScheme") == theme
        assert walker.faults == []


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to look with")
def test_a_tile_tells_the_verdict_in_its_sentence_and_the_report_what_was_not_read(tables, tmp_path):
    file = tmp_path / "r.html"
    file.write_text(made(tables, tmp_path, {"a": {"c1": {"marked": True}}}))
    with walking(CHROMIUM) as walker:
        walker.open(f"file://{file}")
        walker.until("document.querySelector('.tile .account')")
        assert walker.run("document.querySelector('.tile .account').textContent").startswith(
            "⚠ Lacking: 4 of 5 things told"
        )
        told = "[...document.querySelectorAll('.story .told')]"
        assert walker.run(f"{told}.map(s => s.className)") == ["told read", "told contradicts", "told unread"]
        assert walker.run("[...document.querySelectorAll('.told sup')].map(s => s.textContent)") == [
            "contradicted", "not read"
        ]  # fmt: skip


def test_a_case_is_small_so_that_500_stay_quick(tables, tmp_path):
    few = len(made(tables, tmp_path, {"a": {"c0": {}}}))
    more = len(made(tables, tmp_path, {"a": {f"c{k}": {} for k in range(5)}}))
    assert (more - few) / 4 < 2_500


def test_what_is_left_out_says_why(tables, tmp_path):
    assert "Left out: nothing." in made(tables, tmp_path, {"a": {"c1": {}}})


def test_table_and_report_are_commands(study, tmp_path):
    folder = study({"a": {"c1": {}, "c2": {}}, "b": {"c1": {"status": "exhausted"}}})
    out = tmp_path / "runs"
    shown = CliRunner().invoke(
        app,
        ["table", "kit", "--out", str(out), "--csv", str(tmp_path / "t.csv"), "--latex", str(tmp_path / "x" / "t.tex")],
    )
    assert shown.exit_code == 0, shown.output
    assert "3 of 4 runs are done" in shown.output
    assert (tmp_path / "t.csv").read_text().startswith("table,arm,")
    assert r"\toprule" in (tmp_path / "x" / "t.tex").read_text()
    wrote = CliRunner().invoke(app, ["report", str(folder), "--figures", str(tmp_path / "f")])
    assert wrote.exit_code == 0, wrote.output
    assert "figure left out: Sensitivity" in wrote.output
    assert len(data_of((folder / "report.html").read_text())["cases"]) == 2
    assert {f.stem for f in (tmp_path / "f").iterdir()} == {"risk", "displacement", "networks", "frames"}


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to look with")
def test_the_gallery_sorts_filters_and_draws_in_a_browser(tables, tmp_path):
    runs = {"a": {f"c{k}": {"story": EVIL if k else "plain"} for k in range(12)} | {"bad": {"realised": False}}}
    file = tmp_path / "report.html"
    file.write_text(made(tables, tmp_path, runs, about={"title": "Kit"}))
    shown = dom(file, "show=undeclared", tmp_path)
    assert re.search(r"<title>Kit</title>", shown)
    assert ">1 of 13 cases<" in shown
    assert re.findall(r'<article class="card case"><div><h3>(\w+)</h3>', shown) == ["bad"]
    assert re.findall(r'<canvas[^>]* width="360"', shown)
    assert dom(file, "words=plain", tmp_path).count("<article") == 1
    first = re.search(r"<article.*?<h3>(\w+)</h3>", dom(file, "sort=wrong", tmp_path), re.DOTALL)
    assert first.group(1) in runs["a"]


def dom(file, wish, tmp_path):
    """The page as Chromium has made it."""
    return subprocess.run(
        [
            CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--window-size=1300,9000",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            f"--user-data-dir={tmp_path / 'profile'}",
            "--virtual-time-budget=3000", "--dump-dom", f"file://{file}#{wish}",
        ],
        capture_output=True, text=True, timeout=240,
    ).stdout  # fmt: skip


def test_the_reference_arm_tells_the_report_since_others_may_have_read_less(tables, tmp_path):
    runs = {"sparse": {"c1": {"story": "A collision occurred."}}, "full": {"c1": {"story": "All of it."}}}
    assert data_of(made(tables, tmp_path, runs, about={"reference": "full"}))["cases"][0]["text"] == "All of it."
