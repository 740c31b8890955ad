"""The web application: pages, error pages, and the guard around them. Starts no server."""

from __future__ import annotations

import logging
import traceback
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path

from fastapi import FastAPI, Request
from jinja2 import TemplateError
from starlette.exceptions import HTTPException
from starlette.responses import Response

from flows.desk import changes, pages
from flows.desk.context import CaseGone, Desk
from flows.desk.guard import Gate, Guard
from flows.desk.index import ODD, Index
from flows.desk.links import Links
from flows.desk.threads import PageLate


def application(root: Path, gate: Gate | None = None, mlflow: str = "", prefect: str = "") -> FastAPI:
    """The desk over a results folder."""
    desk = Desk(Index(root), Links(root.resolve(), mlflow, prefect))
    app = FastAPI(title="SG-CADVLM desk", docs_url=None, redoc_url=None, openapi_url=None, lifespan=_life(desk))
    app.state.desk = desk
    app.include_router(pages.router)
    app.include_router(changes.router)
    app.add_exception_handler(CaseGone, _gone)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(PageLate, _late)
    for odd in (*ODD, TemplateError, OSError):
        app.add_exception_handler(odd, _odd)
    app.add_middleware(Guard, gate=gate or Gate())
    return app


def _life(desk: Desk) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    """Start reading the folder with the server; end the worker processes with it."""

    @asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        desk.index.listing(0)
        yield
        desk.mender.close()

    return life


def _gone(request: Request, fault: Exception) -> Response:
    return _page(request, 404, "Not found", str(fault))


def _late(request: Request, fault: Exception) -> Response:
    return _page(request, 503, "Not ready", f"{fault} Try again in a moment.")


def _odd(request: Request, fault: Exception) -> Response:
    """A case that no version of this program writes: what was odd, and where, for its owner and for the log."""
    where = traceback.extract_tb(fault.__traceback__)[-1]
    said = f"{type(fault).__name__}: {str(fault)[:200]} ({Path(where.filename).name}:{where.lineno})"
    logging.getLogger(__name__).warning("%s: %s", ascii(request.url.path), said)
    return _page(request, 422, "An odd case", f"Its files hold something that cannot be shown. Run it again. {said}")


def _http(request: Request, fault: Exception) -> Response:
    status = fault.status_code if isinstance(fault, HTTPException) else 500
    words = {404: ("Not found", "There is no such page."), 405: ("Not allowed", "This page accepts no changes.")}
    title, text = words.get(status, ("Fault", "The desk cannot answer this request."))
    return _page(request, status, title, text)


def _page(request: Request, status: int, title: str, text: str) -> Response:
    desk: Desk = request.app.state.desk
    return desk.render(request, "error.html", status, title=title, text=text)
