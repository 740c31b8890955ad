"""The list and the case page over real results: what they show, and that nothing in a report becomes markup."""

import json
import re
import shutil
import time

import pytest
from starlette.testclient import TestClient

from flows.case_files.folder_cases import write_left_out
from flows.desk.app import application
from tests.flows.desk.conftest import EVIL, foreign

CASES = ("across-the-centerline", "left-turn-at-signal", "rear-end-on-arterial")


def test_the_list_shows_every_case_with_what_it_came_to(client, config):
    text = client.get("/").text
    for case in CASES:
        assert f'href="/case/{config.name}/{case}?' in text
    assert "3 cases" in text
    assert "rear-end" in text
    assert "head-on" in text


def test_filters_and_search_are_addresses(client):
    assert "left-turn-at-signal" not in client.get("/?kind=rear-end").text
    assert "1 case <span>of 3</span>" in client.get("/?text=left-turn").text
    assert "No case matches the filters" in client.get("/?text=nothing").text


def test_an_empty_folder_says_how_to_fill_it(tmp_path):
    with TestClient(application(tmp_path), base_url="http://localhost") as client:
        assert "sgcad run REPORT" in client.get("/").text


def test_the_list_names_what_a_batch_left_out(client, config):
    assert "left out" not in client.get("/").text
    write_left_out(config, ("reports/notes.docx",))
    assert "left out, 1 beside the cases: reports/notes.docx" in client.get("/").text


def test_a_case_shows_report_drawing_map_player_facts_and_files(page, config):
    text = page(f"{config.name}/left-turn-at-signal").text
    assert '<polyline points="' in text
    assert f'src="/drawing/1/{config.name}/left-turn-at-signal?' in text
    assert f'src="/player/{config.name}/left-turn-at-signal?' in text
    assert 'sandbox="allow-scripts"' in text
    assert "Vehicle #2, a 1998 Ford Explorer" in text
    assert "scenario.xosc" in text
    assert text.index('class="account"') < text.index('class="desk"')


def test_facts_point_to_their_sentence_and_thing_and_back(page, config):
    text = page(f"{config.name}/left-turn-at-signal").text
    told = re.search(r'data-sentence="(\d+)" data-things="([^"]*)">The front of Vehicle #2 struck', text)
    assert "contact" in told[2].split()
    row = re.search(r'<tr class="fact text" data-things="([^"]*)" data-of="(\d+)" id="f-contacts.0.striker">', text)
    assert (row[1], row[2]) == ("contact", told[1])
    assert re.search(r'data-road="N"[^>]*data-direction="forward"[^>]*data-things="leg:N road:main"', text)
    assert 'data-actor="V1"' in text


def test_every_control_has_a_name(page, config):
    for text in (
        page(f"{config.name}/left-turn-at-signal").text,
        page(f"{config.name}/left-turn-at-signal").client.get("/").text,
    ):
        for tag, attributes, inner in re.findall(r"<(button|a|summary)\b([^>]*)>(.*?)</\1>", text, re.DOTALL):
            assert "aria-label" in attributes or re.sub(r"<[^>]*>", "", inner).strip(), (tag, attributes)
        for name in re.findall(r'<(?:input|select)\b(?![^>]*hidden)[^>]*id="([^"]+)"', text):
            assert f'for="{name}"' in text, name
        assert "style=" not in text
        assert not re.search(r"\son\w+=", text)


def test_nothing_in_a_report_or_a_result_becomes_markup(runs, config, client):
    place = config / "left-turn-at-signal"
    result = json.loads((place / "result.json").read_text())
    result |= {
        "reason": EVIL,
        "config": EVIL,
        "notes": [{"kind": "finding", "field": EVIL, "subject": EVIL, "text": EVIL}],
    }
    result["facts"].append({"field": f"vehicles.{EVIL}.x", "value": EVIL, "basis": "text", "status": "stated",
                            "rule": EVIL, "start": 0, "end": 93, "confidence": 0.5, "nats": None})  # fmt: skip
    result["actors"][0]["type"] = EVIL
    (place / "result.json").write_text(json.dumps(result))
    (place / "report.txt").write_text(EVIL + (place / "report.txt").read_text())
    (place / "attempts" / "road-01" / "findings.json").write_text(json.dumps([{"what": EVIL, "where": EVIL}]))
    foreign(runs / "<b>odd", "<img src=x>&")
    for text in (client.get("/").text, client.get(f"/?text={EVIL}&trust={EVIL}").text,
                 client.get(f"/case/{config.name}/left-turn-at-signal").text,
                 client.get("/case/%3Cb%3Eodd/%3Cimg%20src%3Dx%3E%26").text,
                 client.get(f"/case/{EVIL}").text):  # fmt: skip
        assert "<img src=x" not in text
        assert "<script>" not in text
        assert text.count("</script>") <= 2


def test_only_files_of_a_case_are_handed_out(client, config):
    key = f"{config.name}/left-turn-at-signal"
    kept = client.get(f"/file/scenario.xosc/{key}")
    assert kept.headers["content-disposition"] == 'attachment; filename="left-turn-at-signal-scenario.xosc"'
    assert kept.content == (config / "left-turn-at-signal" / "scenario.xosc").read_bytes()
    for place in (f"/file/.digest/{key}", f"/file/config.yaml/{config.name}", f"/file/..%2Fconfig.yaml/{key}",
                  f"/attempt/road-01/attempt.json/{key}", f"/attempt/..%2F..%2Froad-01/prompt.txt/{key}",
                  f"/drawing/9/{key}",
                  f"/file/report.txt/{config.name}/%2E%2E/{key}", "/static/..%2Fdesk.py", "/static/desk.py",
                  f"/case/{config.name}/..%2F..%2F..%2Fetc"):  # fmt: skip
        assert client.get(place).status_code == 404, place


def test_a_link_inside_a_case_leads_nowhere(client, config, tmp_path):
    (tmp_path / "secret").write_text("secret")
    place = config / "left-turn-at-signal" / "report.txt"
    place.unlink()
    place.symlink_to(tmp_path / "secret")
    answer = client.get(f"/file/report.txt/{config.name}/left-turn-at-signal")
    assert (answer.status_code, "secret" in answer.text) == (404, False)


def test_the_player_is_sealed_off(client, config):
    headers = client.get(f"/player/{config.name}/left-turn-at-signal").headers
    assert headers["content-security-policy"].startswith("sandbox allow-scripts; default-src 'none'")
    assert "allow-same-origin" not in headers["content-security-policy"]


def test_a_removed_case_is_told_of(client, page, config):
    key = f"{config.name}/left-turn-at-signal"
    mine = page(key)
    shutil.rmtree(config / "left-turn-at-signal")
    assert client.get(f"/version/{key}").status_code == 404
    assert "There is no case" in client.get(f"/case/{key}").text
    assert mine.change(**{"roads.N.lanes_forward": 2}).status_code == 404


@pytest.mark.parametrize("status", ["refused", "exhausted", "failed"])
def test_a_case_without_a_scenario_has_a_page_that_says_why(client, runs, status):
    foreign(runs / "kit", "c", status=status, reason="road: too little is told", missing=["lanes"])
    text = client.get("/case/kit/c").text
    assert "road: too little is told" in text
    assert "There is no road network" in text
    assert "nothing to play" in text


def test_a_half_written_result_breaks_neither_list_nor_page(client, config):
    (config / "left-turn-at-signal" / "result.json").write_text('{"status": "gener')
    time.sleep(0.4)
    assert "unreadable" in client.get("/").text
    answer = client.get(f"/case/{config.name}/left-turn-at-signal")
    assert (answer.status_code, "run the case again" in answer.text) == (404, True)


def test_runs_of_mlflow_and_prefect_are_linked_where_they_are_served(runs, config):
    import sqlite3

    with sqlite3.connect(runs / "mlflow.db") as database:
        database.execute("create table runs (run_uuid, experiment_id, lifecycle_stage, start_time)")
        database.execute("create table tags (run_uuid, key, value)")
        database.execute("insert into runs values ('r1', 7, 'active', 1), ('r2', 7, 'deleted', 2)")
        for run in ("r1", "r2"):
            database.execute("insert into tags values (?, 'mlflow.runName', 'left-turn-at-signal')", (run,))
            database.execute("insert into tags values (?, 'sgcad.config', ?)", (run, config.name))
    served = {"mlflow": "http://127.0.0.1:5000", "prefect": "http://127.0.0.1:4200"}
    with TestClient(application(runs, **served), base_url="http://localhost") as client:
        text = client.get(f"/case/{config.name}/left-turn-at-signal").text
        assert 'href="http://127.0.0.1:5000/#/experiments/7/runs/r1"' in text
        assert 'href="http://127.0.0.1:4200/runs' in text
        (runs / "mlflow.db").write_bytes(b"no database")
        assert client.get(f"/case/{config.name}/left-turn-at-signal").status_code == 200
