"""A late page is told of, other pages go on meanwhile, and what cannot be shown is a page, never a 500."""

import threading
import time

import pytest

from flows.desk import pages, threads
from flows.desk.mending import DeskBusy, Mender

CASE = "left-turn-at-signal"


def test_a_late_page_is_told_of_and_holds_no_other(client, config, monkeypatch):
    monkeypatch.setattr(threads, "PAGE_S", 0.5)
    let_go = threading.Event()
    monkeypatch.setattr(pages, "map_of", lambda *_: let_go.wait(30))
    began = time.monotonic()
    answer = client.get(f"/case/{config.name}/{CASE}")
    assert (answer.status_code, "was not ready within 0.5 s" in answer.text) == (503, True)
    assert client.get(f"/version/{config.name}/{CASE}").status_code == 200
    assert time.monotonic() - began < 20
    let_go.set()


@pytest.mark.parametrize("fault", [KeyError("x"), ValueError("odd"), RecursionError("deep"), OSError(5, "I/O error")])
def test_what_no_version_writes_is_a_page_that_says_what_was_odd(client, config, monkeypatch, fault):
    def stumble(*_):
        raise fault

    monkeypatch.setattr(pages, "map_of", stumble)
    answer = client.get(f"/case/{config.name}/{CASE}")
    assert (answer.status_code, type(fault).__name__ in answer.text) == (422, True)


def test_a_busy_desk_answers_an_edit_with_its_reason_and_shows_pages(page, config, monkeypatch):
    mine = page(f"{config.name}/{CASE}")

    def busy(self, order, version):
        raise DeskBusy("12 other changes wait already. Yours was not made: try again in a moment.")

    monkeypatch.setattr(Mender, "change", busy)
    answer = mine.change(**{"roads.N.lanes_forward": 2})
    assert (answer.status_code, "try again" in answer.json()["text"]) == (503, True)
    assert page(f"{config.name}/{CASE}").status == 200


def test_changes_that_wait_take_no_thread_of_pages(page, config, client, monkeypatch):
    let_go, mine = threading.Event(), page(f"{config.name}/{CASE}")
    monkeypatch.setattr(Mender, "change", lambda *_: let_go.wait(60))
    count = int(threads.Threads().changes.total_tokens) + 4
    calls = [threading.Thread(target=mine.change, daemon=True) for _ in range(count)]
    for call in calls:
        call.start()
    time.sleep(1)
    began = time.monotonic()
    assert client.get("/").status_code == 200
    assert client.get(f"/version/{config.name}/{CASE}").status_code == 200
    assert time.monotonic() - began < 10
    let_go.set()
    for call in calls:
        call.join(30)
