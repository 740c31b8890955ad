"""The desk's requests that change a case: edit, undo, run again; JSON in, JSON out, behind the guard."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path
from typing import Any

from anyio import to_thread
from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.responses import JSONResponse, Response

from flows.desk.context import Desk
from flows.desk.mending import CaseChanged, ChangeResult, DeskBusy, Kind, Order, told
from sgcad_core.errors import SgcadError, SimulationFailed, WrongEdit
from sgcad_core.system.temp_folders import temp_folder

router = APIRouter()
Plain = str | int | float | bool | list[str] | None


class ChangeRequest(BaseModel):
    """A change as a page requests it."""

    model_config = ConfigDict(extra="forbid")
    version: str = Field(max_length=80)
    stamp: str = Field("", max_length=80)
    edits: dict[str, Plain] = Field(default_factory=dict, max_length=60)
    who: str = Field("", max_length=120)
    why: str = Field("", max_length=1000)


@router.post("/edit/{key:path}")
async def edit(request: Request, key: str) -> Response:
    """Apply facts to a case."""
    return await _change(request, key, "revise")


@router.post("/undo/{key:path}")
async def undo(request: Request, key: str) -> Response:
    """Undo the last change."""
    return await _change(request, key, "undo")


@router.post("/rerun/{key:path}")
async def rerun(request: Request, key: str) -> Response:
    """Run the case again."""
    return await _change(request, key, "rerun")


async def _change(request: Request, key: str, kind: Kind) -> Response:
    """Answer 200 with findings by field, 409 if the case has changed, 422 with the reason of a refusal."""
    desk: Desk = request.app.state.desk
    try:
        asked = ChangeRequest.model_validate_json(await request.body())
    except ValidationError as fault:
        return JSONResponse({"text": f"The page sent no change: {fault.errors()[0]['msg']}. Reload it."}, 400)
    _, folder = await to_thread.run_sync(desk.case, key, limiter=desk.threads.pages)
    with temp_folder("desk") as place:
        (permit := place / "permit").touch()
        order = Order(kind, folder, asked.edits, asked.who, asked.why, asked.stamp or None, permit)
        watch = asyncio.create_task(_withdraw(request, permit))
        try:
            change = partial(desk.mender.change, order, asked.version)
            done: ChangeResult = await to_thread.run_sync(change, limiter=desk.threads.changes)
        except SgcadError as fault:
            return JSONResponse(_refusal(fault), _status(fault))
        finally:
            watch.cancel()
    return JSONResponse({"status": done.status, "seconds": round(done.seconds, 3), "changed": done.changed,
                         "findings": {name: list(lines) for name, lines in done.findings.items()}})  # fmt: skip


async def _withdraw(request: Request, permit: Path) -> None:
    """Take the permit of a change back when its client goes."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
    permit.unlink(missing_ok=True)


def _status(fault: SgcadError) -> int:
    return 409 if isinstance(fault, CaseChanged) else 503 if isinstance(fault, SimulationFailed | DeskBusy) else 422


def _refusal(fault: SgcadError) -> dict[str, Any]:
    """The reason of a refusal, and findings by field."""
    fields: dict[str, list[str]] = {}
    for finding in getattr(fault, "findings", ()) if isinstance(fault, WrongEdit) else ():
        fields.setdefault(finding.where, []).append(finding.what)
    return {"text": told(fault), "fields": fields}
