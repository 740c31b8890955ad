"""Requests to the desk over a results folder in which files are odd: paths, headers, bodies, changes of odd kinds."""

from __future__ import annotations

import base64
import json
import os
import random
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from research.benchmarks.fuzz.making import NUMBERS, PIECES, changed

NAME = "desk requests"
SPOILED = (
    "result.json", "links.json", "report.txt", "road.net.xml", "trajectories.csv", "player.html", "specs.json",
    ".source",
    "facts.yaml", "diagram.png", "attempts/road-01/findings.json", "attempts/road-01/attempt.json", "steps.json",
)  # fmt: skip
PATHS = (
    "/", "/case/{k}", "/version/{k}", "/player/{k}", "/drawing/{n}/{k}", "/file/{f}/{k}", "/attempt/road-01/{f}/{k}",
    "/static/{f}", "/edit/{k}", "/undo/{k}", "/rerun/{k}", "/{k}", "/case/{k}/{k}",
)  # fmt: skip
KEYS = (
    "template/c", "template/c", "template/c", "template", "../c", "template/..%2f..%2fetc", "%2e%2e/%2e%2e/etc/passwd",
    "template/c/", "//", "%00", "%ff%fe", "a" * 3000, "template/.partial-1-x", "~", "template/c?x=%", "attempts/c",
)  # fmt: skip
FIELDS = (
    "roads.N.lanes_forward",
    "vehicles.V1.maneuver",
    "no.such",
    "contacts.0.striker",
    "",
    "a." * 2000,
    "junction.kind",
)
NESTED = 100_000
ODD_FACT = {"field": "x", "value": 1, "basis": [], "status": 3}


def inputs(rng: random.Random, folder: Path) -> Iterator[str]:
    """JSON of a file to spoil and the requests that follow."""
    while True:
        spoiled = [rng.choice(SPOILED), *_content(rng)] if rng.random() < 0.5 else []
        asked = [_request(rng) for _ in range(rng.choice((1, 2, 4)))]
        yield json.dumps({"spoiled": spoiled, "asked": asked})


def _content(rng: random.Random) -> list[str]:
    """How a file is spoiled, and its content in base64."""
    way = rng.choice(("text", "text", "text", "pipe", "link", "folder", "gone", "changed"))
    texts = (
        "[]", "7", '"x"', "[" * NESTED, '{"status": "generated"}', "null", "{}", '{"a": ' * 9000, "x" * 6_000_000,
        "NaN",
        json.dumps({"status": "generated", rng.choice(("facts", "account", "notes", "actors")): rng.choice(NUMBERS)}),
        json.dumps({"status": "generated", "facts": [ODD_FACT | {"field": rng.choice(PIECES)}]}),
    )  # fmt: skip
    content = rng.randbytes(300) if rng.random() < 0.2 else rng.choice(texts).encode("utf-8", "replace")
    return [way, base64.b64encode(content).decode()]


def _request(rng: random.Random) -> dict[str, Any]:
    path = (
        rng.choice(PATHS).replace("{k}", rng.choice(KEYS)).replace("{n}", rng.choice(("1", "0", "-1", "9" * 30, "x")))
    )
    path = path.replace(
        "{f}", rng.choice(("result.json", "report.txt", "..%2fconfig.yaml", "desk.css", ".digest", "%00"))
    )
    query = f"?{rng.choice(('page', 'sort', 'text', 'below', 'trust', 'token'))}={rng.choice(NUMBERS)}"
    method = (
        "POST" if path.startswith(("/edit", "/undo", "/rerun")) else rng.choice(("GET", "GET", "GET", "HEAD", "PUT"))
    )
    headers = {rng.choice(("host", "origin", "cookie", "x-desk-token", "content-length")): rng.choice(NUMBERS) or "x"}
    return {
        "method": method, "path": path + (query if rng.random() < 0.3 else ""),
        "headers": headers if rng.random() < 0.2 else {}, "body": _body(rng) if method != "GET" else "",
    }  # fmt: skip


def _body(rng: random.Random) -> str:
    value: Any = rng.choice((1, -1, 10**30, None, True, "x" * 9000, [], ["a"], {}, "!!int ''", "[" * 5000, *NUMBERS))
    whole = {"version": rng.choice(("", "x", "{version}")), "stamp": "", "edits": {rng.choice(FIELDS): value}}
    whole |= rng.choice(({}, {}, {"who": "\x00" * 50}, {"why": "x" * 5000}, {"more": 1}, {"edits": [1]}))
    texts = (json.dumps(whole), changed(json.dumps(whole), rng).decode("utf-8", "replace"), "[" * NESTED, "", "null")
    return texts[rng.choices(range(5), (6, 3, 1, 1, 1))[0]]


# ------------------------------------------------------------------ the desk
@cache
def _desk() -> tuple[Any, Path, Path]:
    """A client of a desk over one finished case, its folder, and a copy of it to restore."""
    from fastapi.testclient import TestClient

    from flows.batch.config_folder import write
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case, digest_of
    from flows.desk.app import application
    from sgcad_core import settings
    from sgcad_core.config import load

    place = Path(os.environ["TMPDIR"]) / "desk"
    shutil.copytree(settings.ROOT / "docs" / "demo" / "left-turn-at-signal", place / "reports" / "c")
    config, case = load(settings.CONFIGS / "template.yaml", ("tracker=none",)), Case(place / "reports" / "c", "c")
    write(place / "runs" / config.name, config)
    run_case(config, case, place / "runs", digest_of(case, config))
    folder = place / "runs" / config.name / "c"
    shutil.copytree(place, place.with_name("kept"))
    client = TestClient(application(place / "runs"), base_url="http://localhost", follow_redirects=False)
    client.__enter__()  # for as long as the process lives: the workers end with its pipes
    return client, folder, place.with_name("kept")


def feed(item: str) -> None:
    """Spoil the file, ask, and restore. Raises AssertionError for a 5xx, and for what must not be shown."""
    asked = json.loads(item)
    client, folder, kept = _desk()
    try:
        if asked["spoiled"]:
            _spoil(folder, *asked["spoiled"])
        for one in asked["asked"]:
            _ask(client, folder, one)
    finally:
        if asked["spoiled"] or any(one["method"] == "POST" for one in asked["asked"]):
            for part in ("runs", "reports"):
                shutil.rmtree(folder.parents[2] / part, ignore_errors=True)
                shutil.copytree(kept / part, folder.parents[2] / part)


def _spoil(folder: Path, name: str, way: str, content: str) -> None:
    file, raw = folder / name, base64.b64decode(content)
    before = file.read_bytes() if file.is_file() else b""
    file.unlink(missing_ok=True)
    if way == "pipe":
        os.mkfifo(file)
    elif way == "link":
        file.symlink_to("/etc/passwd")
    elif way == "folder":
        file.mkdir()
    elif way != "gone":
        file.write_bytes(raw if way == "text" else before[: len(before) // 2] + raw[:3] + before[len(before) // 2 :])


def _ask(client: Any, folder: Path, one: dict[str, Any]) -> None:
    from flows.case_files.case_version import version_of

    client.cookies.clear()
    headers = {name: str(value).encode("utf-8", "replace") for name, value in one["headers"].items()}
    if one["method"] == "POST" and "x-desk-token" not in headers:
        shown = client.get("/").text
        headers["x-desk-token"] = shown.partition('name="desk-token" content="')[2].partition('"')[0].encode()
    body = one["body"].replace("{version}", version_of(folder)).encode("utf-8", "replace")
    answer = client.request(one["method"], one["path"], headers=headers, content=body or None)
    if answer.status_code >= 500:
        raise AssertionError(f"{one['method']} {one['path'][:80]} -> {answer.status_code}: {answer.text[-200:]}")
    if b"root:x:0" in answer.content:
        raise AssertionError(f"{one['path'][:80]} shows what a link leads to")
