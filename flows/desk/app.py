"""The web application: pages, errors in words, the guard around all of it. Starts no server."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path

from fastapi import FastAPI, Request
from starlette.exceptions import HTTPException
from starlette.responses import Response

from flows.desk import changes, pages
from flows.desk.context import Desk, Gone
from flows.desk.guard import Gate, Guard
from flows.desk.index import Index
from flows.desk.links import Links


def application(root: Path, gate: Gate | None = None, mlflow: str = "", prefect: str = "") -> FastAPI:
    """The desk over a results folder."""
    desk = Desk(Index(root), Links(root.resolve(), mlflow, prefect))
    app = FastAPI(title="SG-CADVLM desk", docs_url=None, redoc_url=None, openapi_url=None, lifespan=_life(desk))
    app.state.desk = desk
    app.include_router(pages.router)
    app.include_router(changes.router)
    app.add_exception_handler(Gone, _gone)
    app.add_exception_handler(HTTPException, _http)
    app.add_middleware(Guard, gate=gate or Gate())
    return app


def _life(desk: Desk) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    """Begin to read as the server starts; end the processes with it."""

    @asynccontextmanager
    async def life(_: FastAPI) -> AsyncIterator[None]:
        desk.index.listing(0)
        yield
        desk.mender.close()

    return life


def _gone(request: Request, fault: Exception) -> Response:
    return _page(request, 404, "Not here", str(fault))


def _http(request: Request, fault: Exception) -> Response:
    status = fault.status_code if isinstance(fault, HTTPException) else 500
    words = {404: ("Not here", "There is no such page."), 405: ("Not so", "This page only shows; it takes no changes.")}
    title, text = words.get(status, ("That did not work", "The desk cannot answer this."))
    return _page(request, status, title, text)


def _page(request: Request, status: int, title: str, text: str) -> Response:
    desk: Desk = request.app.state.desk
    return desk.render(request, "error.html", status, title=title, text=text)
