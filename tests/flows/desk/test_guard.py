"""Who may come in: host names, the token, changes from elsewhere, and what a page may load."""

import socket
import subprocess
import sys
import time

import httpx
import pytest
from starlette.testclient import TestClient

from flows.desk.app import application
from flows.desk.command import DeskOptions, address_of, gate_of
from flows.desk.guard import Gate
from sgcad_core.errors import ConfigError
from tests.flows.desk.conftest import Page, foreign

EVERYWHERE = "0.0.0.0"  # noqa: S104 - what is guarded against
TOKEN = "a-token-of-some-length"  # noqa: S105 - of this test alone


@pytest.fixture
def folder(tmp_path):
    foreign(tmp_path / "kit", "c1")
    return tmp_path


def visitor(folder, host="localhost", **gate):
    return TestClient(application(folder, Gate(**gate)), base_url=f"http://{host}", follow_redirects=False)


@pytest.mark.parametrize("host", ["localhost", "localhost:8321", "127.0.0.1:1", "[::1]:8321", "LOCALHOST"])
def test_the_desk_answers_to_its_own_names(folder, host):
    assert visitor(folder).get("/", headers={"host": host}).status_code == 200


@pytest.mark.parametrize(
    "host", ["evil.example", "localhost.evil.example", "evil@localhost.evil", "", "192.168.1.7", "[::1", "a:b:c"]
)
def test_a_request_for_another_host_learns_nothing(folder, host):
    answer = visitor(folder).get("/", headers={"host": host})
    assert answer.status_code == 421
    assert "c1" not in answer.text


def test_beyond_this_machine_an_address_is_a_name_and_a_foreign_name_is_none(folder):
    names = gate_of(DeskOptions(folder, EVERYWHERE, 1, names=("crash.example",)))
    client = TestClient(application(folder, names), base_url="http://192.168.1.7")
    assert client.get("/").status_code == 401
    assert client.get("/", headers={"host": "crash.example"}).status_code == 401
    assert client.get("/", headers={"host": "evil.example"}).status_code == 421


def test_beyond_this_machine_a_token_is_made_and_on_it_none_is_needed(folder):
    away, here = gate_of(DeskOptions(folder, EVERYWHERE, 1)), gate_of(DeskOptions(folder, "127.0.0.1", 1))
    assert len(away.token) >= 32
    assert here.token == ""
    assert address_of("10.0.0.1", 80, away.token).endswith(f"/?token={away.token}")
    with pytest.raises(ConfigError, match="--token: 5 characters can be guessed; give 16 or more"):
        gate_of(DeskOptions(folder, "127.0.0.1", 1, token="x" * 5))


def test_the_token_becomes_a_cookie_at_the_first_visit_and_leaves_the_address(folder):
    client = visitor(folder, token=TOKEN)
    assert client.get("/").status_code == 401
    assert client.get("/?token=wrong").status_code == 401
    assert client.get("/static/desk.css").status_code == 401
    answer = client.get(f"/case/kit/c1?sort=case&token={TOKEN}")
    assert (answer.status_code, answer.headers["location"]) == (303, "/case/kit/c1?sort=case")
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=lax" in cookie
    assert client.get("/case/kit/c1").status_code == 200


def test_a_redirect_never_leads_to_another_host(folder):
    answer = visitor(folder, token=TOKEN).get(f"http://localhost//evil.example/?token={TOKEN}")
    assert answer.headers["location"].startswith("/evil.example")


@pytest.mark.parametrize(
    "headers",
    [{"x-desk-token": ""}, {"x-desk-token": "0" * 64}, {"origin": "http://evil.example"}, {"origin": "null"},
     {"sec-fetch-site": "cross-site"}, {"sec-fetch-site": "same-site"}, {"origin": "http://localhost:9"}],
)  # fmt: skip
def test_a_change_from_elsewhere_is_refused(folder, headers):
    with visitor(folder) as client:
        page = Page(client, "kit/c1")
        assert page.change(headers=headers, **{"roads.N.lanes_forward": 2}).status_code == 403


def test_a_change_without_the_visitors_cookie_is_refused(folder):
    client = visitor(folder)
    token = Page(client, "kit/c1").token
    client.cookies.clear()
    assert client.post("/edit/kit/c1", json={}, headers={"x-desk-token": token}).status_code == 403


def test_another_visitors_token_is_refused(folder):
    first, second = visitor(folder), visitor(folder)
    token = Page(first, "kit/c1").token
    Page(second, "kit/c1")
    assert second.post("/edit/kit/c1", json={}, headers={"x-desk-token": token}).status_code == 403


def test_a_change_says_its_length_and_is_short(folder):
    client = visitor(folder)
    token = Page(client, "kit/c1").token
    large = client.post("/edit/kit/c1", content=b"x" * 1_000_001, headers={"x-desk-token": token})
    assert large.status_code == 413
    endless = client.post("/edit/kit/c1", content=iter([b"{}"]), headers={"x-desk-token": token})
    assert endless.status_code == 411


def test_links_change_nothing(folder):
    client = visitor(folder)
    for place in ("/edit/kit/c1", "/undo/kit/c1", "/rerun/kit/c1"):
        assert client.get(place).status_code in (404, 405)


def test_pages_may_load_nothing_from_elsewhere_and_run_nothing_inline(folder):
    client = visitor(folder)
    for place in ("/", "/case/kit/c1", "/nothing", "/static/desk.css"):
        headers = client.get(place).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "frame-ancestors 'none'" in policy
        assert headers["x-content-type-options"] == "nosniff"


# ------------------------------------------------------------------ the real server
def test_a_real_server_starts_tells_where_it_is_and_ends(folder):
    command = [sys.executable, "-c", "from flows.cli import main; main()", "desk", str(folder), "--port", "0"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        said = "".join(iter(lambda: server.stdout.readline(), "Ctrl-C ends it.\n"))
        address = next(word for word in said.split() if word.startswith("http"))
        assert address.startswith("http://127.0.0.1:")
        with httpx.Client(base_url=address) as client:
            deadline = time.monotonic() + 60
            while "c1" not in client.get("/").text:
                assert time.monotonic() < deadline
            assert client.get("/", headers={"host": "evil.example"}).status_code == 421
    finally:
        server.terminate()
        server.wait(20)
    assert "Traceback" not in server.stderr.read()


def desk_says(*words):
    command = [sys.executable, "-c", "from flows.cli import main; main()", "desk", *map(str, words)]
    said = subprocess.run(command, capture_output=True, text=True, timeout=240)
    return said.returncode, said.stderr


@pytest.mark.slow
def test_a_wrong_folder_a_case_and_a_taken_port_are_told_with_their_remedy(folder):
    code, said = desk_says(folder / "none")
    assert (code, "no such folder; make results first" in said) == (2, True)
    code, said = desk_says(folder / "kit" / "c1")
    assert (code, f"is one case; give the results folder above it, such as {folder}" in said) == (2, True)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        code, said = desk_says(folder, "--port", taken.getsockname()[1])
    assert (code, "--port 0 selects a free port" in said) == (2, True)
    code, said = desk_says(folder, "--mlflow", "javascript:alert(1)")
    assert (code, "no web address" in said) == (2, True)
