"""The desk's read-only pages: list, case, player, drawings, files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response

from flows.case_files.case_version import version_of
from flows.case_files.folder_cases import left_out_line, read_left_out
from flows.desk.context import STATIC, CaseGone, Desk
from flows.desk.threads import timed
from flows.desk.views import attempts, case_view, edit_form, filters, folder_files
from flows.desk.views.filters import ListQuery
from flows.desk.views.list_rows import Row
from flows.desk.views.map_shapes import map_of
from sgcad_core.errors import BadInput, SgcadError
from sgcad_core.records.edits import effective

router = APIRouter()
PLAYER_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data:; frame-ancestors 'self'"
)
"""The player is one file with its script inside. It gets an origin of its own, no cookie and no network."""
MOST_CONFIGS = 100
"""Configs of whose batches the list says what they left out."""
STATIC_TYPES = {".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".txt": "text/plain"}


def desk_of(request: Request) -> Desk:
    """The desk that answers."""
    desk: Desk = request.app.state.desk
    return desk


@router.get("/")
@timed
def list_page(request: Request) -> Response:
    """The list of cases, filtered and sorted."""
    desk, asked = desk_of(request), ListQuery.of(request.query_params)
    listing = desk.index.listing()
    everything = list(listing.rows.values())
    rows = filters.chosen(everything, asked)
    shown, number, pages = filters.page_of(rows, asked)
    facets = filters.counts(everything, asked)
    return desk.render(
        request, "list.html", asked=asked, rows=shown, found=len(rows), total=len(everything), pending=listing.pending,
        left=left_out_line(_left_out(desk, everything)), number=number, pages=pages, facets=facets,
        facet_words=filters.FACETS, flags=filters.FLAGS,
        sorts=filters.SORTS, first=(number - 1) * filters.PAGE,
    )  # fmt: skip


def _left_out(desk: Desk, rows: Iterable[Row]) -> list[str]:
    """What batches found in their folders of cases and did not run."""
    configs = sorted({row.key.rpartition("/")[0] for row in rows if "/" in row.key})[:MOST_CONFIGS]
    return list(dict.fromkeys(name for config in configs for name in read_left_out(desk.root / config)))


@router.get("/case/{key:path}")
@timed
def case_page(request: Request, key: str) -> Response:
    """One case: report, drawing, map, player, facts."""
    desk, asked = desk_of(request), ListQuery.of(request.query_params)
    row, folder = desk.case(key)
    result = desk.result(folder)
    rows = filters.chosen(desk.index.listing().rows.values(), asked)
    before, after, number = filters.around(rows, key)
    page = case_view.page_of(folder, result)
    return desk.render(
        request, "case.html", row=row, page=page, thing_of=case_view.thing_of, road_map=map_of(folder, result),
        asked=asked, before=before, after=after, number=number, found=len(rows), version=version_of(folder),
        links=desk.links.of(key, str(result.get("config") or ""), row.case), **mending_of(desk, page, folder),
    )  # fmt: skip


def mending_of(desk: Desk, page: case_view.CasePage, folder: Path) -> dict[str, Any]:
    """Template values for editing a case, or the reason why it cannot be edited."""
    from flows.case import revise_case

    nothing = {"groups": page.groups, "can_mend": False, "edits": (), "additions": (), "stamp": ""}
    try:
        edits = revise_case.opened(folder).edits()
        fields = revise_case.editable(folder)
    except SgcadError as fault:
        return nothing | {"no_mend": f"cannot be changed here: {fault}"}
    desk.mender.warm(folder)
    stands = effective(edits)
    groups = edit_form.groups_with(page.groups, fields, stands, desk.mender.said(folder))
    return {"groups": groups, "can_mend": True, "no_mend": "", "edits": stands, "stamp": revise_case.stamp_of(edits),
            "additions": list(edit_form.additions(fields))}  # fmt: skip


@router.get("/version/{key:path}")
@timed
def version(request: Request, key: str) -> Response:
    """The version on disk, so that an open page notices a change."""
    _, folder = desk_of(request).case(key)
    return JSONResponse({"version": version_of(folder)})


@router.get("/player/{key:path}")
@timed
def player(request: Request, key: str) -> Response:
    """The case's player, in a sandbox."""
    return _file(request, key, "player.html", "text/html; charset=utf-8", {"Content-Security-Policy": PLAYER_POLICY})


@router.get("/drawing/{number}/{key:path}")
@timed
def drawing(request: Request, number: int, key: str) -> Response:
    """One of the report's drawings, from 1."""
    _, folder = desk_of(request).case(key)
    found = folder_files.diagrams_of(folder)
    if not 1 <= number <= len(found):
        raise CaseGone(f"This report has {len(found)} drawings; there is no number {number}.")
    return _file(request, key, found[number - 1].name, "image/png", {})


@router.get("/file/{name}/{key:path}")
@timed
def download(request: Request, name: str, key: str) -> Response:
    """One of the case's files to download."""
    if name not in folder_files.FILES:
        raise CaseGone(f"{name!r} is no file of a case.")
    case = key.rpartition("/")[2]
    return _file(request, key, name, "application/octet-stream", {}, filename=f"{case}-{name}")


@router.get("/attempt/{attempt}/{name}/{key:path}")
@timed
def attempt(request: Request, attempt: str, name: str, key: str) -> Response:
    """A writer's prompt or answer as plain text."""
    if not attempts.ATTEMPT.fullmatch(attempt) or name not in attempts.ATTEMPT_FILES:
        raise CaseGone(f"{attempt}/{name} is no file of an attempt.")
    return _file(request, key, f"attempts/{attempt}/{name}", "text/plain; charset=utf-8", {})


@router.get("/static/{name}")
def static(name: str) -> Response:
    """A style, a script or the icon."""
    file = STATIC / name
    if file.suffix not in STATIC_TYPES or file.parent != STATIC or not file.is_file():
        return PlainTextResponse(f"There is no {name}.", 404)
    return FileResponse(file, media_type=STATIC_TYPES[file.suffix], headers={"Cache-Control": "no-cache"})


def _file(
    request: Request, key: str, name: str, kind: str, headers: Mapping[str, str], filename: str | None = None
) -> Response:
    """A regular file inside a case's folder, read whole: a batch may replace it after its length was sent."""
    _, folder = desk_of(request).case(key)
    if not os.path.lexists(folder / name):
        raise CaseGone(f"This case has no {name}.")
    try:
        content = folder_files.content_of(folder, name)
    except BadInput as fault:
        raise CaseGone(f"{name} of this case is not shown: {str(fault).replace(str(folder), 'the case')}") from fault
    kept = {"Content-Disposition": f"attachment; {_named(filename)}"} if filename else {}
    return Response(content, media_type=kind, headers={**headers, **kept})


def _named(filename: str) -> str:
    """A file's name as a header takes it (RFC 6266); other letters than ASCII in RFC 5987's spelling."""
    spelled = quote(filename, safe="")
    return f'filename="{filename}"' if spelled == filename else f"filename*=utf-8''{spelled}"
