"""The desk shows regular files inside a case's folder alone, and says what is odd in the others."""

import json
import os
import shutil
import time
from itertools import product

import pytest

from flows.desk import index
from flows.desk.views.folder_files import odd_files, result_in, text_of
from flows.desk.views.result_shape import shape_fault
from tests.effort import spread

CASE = "left-turn-at-signal"
LIMIT_S = 10
GOOD = {"status": "generated", "facts": [], "notes": []}
FACT = {"field": "junction.kind", "value": "4-leg", "basis": "text", "status": "stated", "confidence": 0.5}


FILES = ("result.json", "report.txt", "road.net.xml", "trajectories.csv", "player.html", "links.json", ".source",
         "specs.json", "facts.yaml", "diagram.png", "attempts/road-01/findings.json")  # fmt: skip
BESIDE = ("links.json", "specs.json", "steps.json", "attempts/road-01/attempt.json")


@pytest.fixture(autouse=True)
def _at_once(monkeypatch):
    """The folder is looked through for every list: pages may not show what stood there before."""
    monkeypatch.setattr(index, "FRESH_S", 0.0)


def pages(key):
    yield from ("/", f"/case/{key}", f"/version/{key}", f"/player/{key}", f"/drawing/1/{key}")
    yield from (f"/file/{name}/{key}" for name in ("result.json", "report.txt", "road.net.xml", "facts.yaml"))
    yield from (f"/attempt/road-01/{name}/{key}" for name in ("prompt.txt", "findings.json"))


def seen(client, key):
    """Answers of every page of a case, none of them a 5xx and none late."""
    found = {}
    for page in pages(key):
        began = time.monotonic()
        answer = client.get(page)
        assert answer.status_code < 500, (page, answer.text)
        assert time.monotonic() - began < LIMIT_S, page
        found[page] = answer
    return found


def test_a_link_that_leads_out_is_not_shown_and_a_pipe_is_not_waited_for(tmp_path):
    (tmp_path / "private.txt").write_text("private")
    (case := tmp_path / "case").mkdir()
    (case / "report.txt").symlink_to(tmp_path / "private.txt")
    os.mkfifo(case / "player.html")
    (case / "own.txt").write_text("own")
    assert [text_of(case, name) for name in ("report.txt", "player.html", "own.txt", "none")] == ["", "", "own", ""]
    assert list(odd_files(case)) == [
        "report.txt leads out of the case's folder and is not shown",
        "player.html is no regular file and is not shown",
    ]


@pytest.mark.parametrize(("kind", "name"), spread(product(("pipe", "link", "folder"), FILES), 3))
def test_no_page_waits_for_a_pipe_or_shows_what_a_link_leads_to(client, config, tmp_path, name, kind):
    place = config / CASE / name
    place.unlink(missing_ok=True)
    private = tmp_path / "private"
    private.write_text(json.dumps(GOOD | {"reason": "private", "case": "private"}))
    {"pipe": os.mkfifo, "link": lambda p: p.symlink_to(private), "folder": os.mkdir}[kind](place)
    for page, answer in seen(client, f"{config.name}/{CASE}").items():
        assert "private" not in answer.text.replace(str(tmp_path), ""), page


def test_a_linked_folder_of_attempts_is_not_shown(client, config, tmp_path):
    (tmp_path / "elsewhere" / "road-01").mkdir(parents=True)
    (tmp_path / "elsewhere" / "road-01" / "findings.json").write_text('[{"what": "private"}]')
    shutil.rmtree(config / CASE / "attempts")
    (config / CASE / "attempts").symlink_to(tmp_path / "elsewhere")
    answers = seen(client, f"{config.name}/{CASE}")
    assert not [page for page, answer in answers.items() if "private" in answer.text]
    assert "attempts leads out of the case" in answers[f"/case/{config.name}/{CASE}"].text


ODD = {
    "list": "[]",
    "number": "7",
    "text": '"x"',
    "deep": "[" * 100_000,
    "deep inside": '{"status": "generated", "facts": ' + "[" * 50_000 + "]" * 50_000 + "}",
    "other bytes": b"\xff\xfe\x00{",
    "empty": "",
    "no status": "{}",
    "long number": '{"status": "generated", "seconds": {"read": ' + "9" * 4000 + "}}",
    "infinite": '{"status": "generated", "seconds": {"read": 1e999}}',
    "null": json.dumps(dict.fromkeys(("status", "facts", "notes", "account"))),
    "status of another type": json.dumps(GOOD | {"status": ["generated"]}),
    "facts are text": json.dumps(GOOD | {"facts": "facts"}),
    "a fact is a number": json.dumps(GOOD | {"facts": [1]}),
    "a fact has no value": json.dumps(GOOD | {"facts": [{"field": "x"}]}),
    "a fact starts in a list": json.dumps(GOOD | {"facts": [FACT | {"start": [1]}]}),
    "a fact is not a number sure": json.dumps(GOOD | {"facts": [FACT | {"confidence": float("nan")}]}),
    "an account of nothing": json.dumps(GOOD | {"account": {"told": "many"}}),
    "actors by name": json.dumps(GOOD | {"actors": {"V1": 1}}),
    "a contact of numbers": json.dumps(GOOD | {"collision": {"declared": {"striker": 1}}}),
    "notes of lists": json.dumps(GOOD | {"notes": [[1]]}),
    "sentences of text": json.dumps(GOOD | {"sentences": ["x"]}),
}


@pytest.mark.parametrize("name", ODD)
def test_an_odd_result_is_a_page_that_says_what_is_odd(client, config, name):
    content = ODD[name]
    (config / CASE / "result.json").write_bytes(content if isinstance(content, bytes) else content.encode())
    answers = seen(client, f"{config.name}/{CASE}")
    page = answers[f"/case/{config.name}/{CASE}"]
    assert page.status_code == 404
    assert "result.json is no " in page.text
    assert "unreadable" in answers["/"].text


@pytest.mark.parametrize(("file", "name"), spread(product(BESIDE, [n for n in ODD if n != "no status"]), 4))
def test_odd_json_beside_a_result_costs_no_page(client, config, file, name):
    content = ODD[name]
    (config / CASE / file).write_bytes(content if isinstance(content, bytes) else content.encode())
    assert seen(client, f"{config.name}/{CASE}")[f"/case/{config.name}/{CASE}"].status_code == 200


@pytest.mark.parametrize(
    "link", ["http://[", 7, ["http://x"], "//evil", "javascript:alert(1)", None, {"a": "http://x"}]
)
def test_only_addresses_become_links(client, config, link):
    names = ("prefect", "prefect_case", "mlflow")
    (config / CASE / "links.json").write_text(json.dumps(dict.fromkeys(names, link)))
    page = seen(client, f"{config.name}/{CASE}")[f"/case/{config.name}/{CASE}"]
    assert page.status_code == 200
    assert "↗" not in page.text


def test_what_the_program_writes_is_a_result(config):
    for folder in (file.parent for file in config.glob("*/result.json")):
        assert result_in(folder)["status"] == "generated"


def test_an_older_result_is_one_too():
    assert not shape_fault({"status": "generated", "notes": ["plain"], "facts": [FACT], "seconds": {"road": 1}})
    assert shape_fault({"status": "generated", "notes": [3]}).startswith("notes.0")
