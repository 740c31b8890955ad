"""The shared state of the desk's pages: index, links, mending workers, templates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from starlette.requests import Request
from starlette.responses import HTMLResponse

from flows.desk.index import Index
from flows.desk.links import Links
from flows.desk.mending import Mender
from flows.desk.threads import Threads
from flows.desk.views.folder_files import OddResult, result_in
from flows.desk.views.list_rows import UNREADABLE, Row
from sgcad_core.errors import BadInput

STATIC = Path(__file__).parent / "static"
TRUST_WORDS: Mapping[str, str] = {
    "broken": "no scenario", "lacking": "lacking", "doubtful": "doubtful", "refused": "refused", "whole": "holds",
}  # fmt: skip
BASIS_WORDS: Mapping[str, str] = {
    "text": "report", "diagram": "drawing", "model": "model", "default": "assumed", "person": "person",
    "coded": "coded",
}  # fmt: skip


class CaseGone(Exception):
    """A case that does not exist (any more); the message is shown."""


@dataclass
class Desk:
    """One results folder on the web."""

    index: Index
    links: Links
    mender: Mender = field(default_factory=Mender)
    threads: Threads = field(default_factory=Threads)
    templates: Environment = field(default_factory=lambda: _templates())

    @property
    def root(self) -> Path:
        """The results folder."""
        return self.index.root

    def case(self, key: str) -> tuple[Row, Path]:
        """A case's row and folder. Raises Gone, also for one whose result cannot be read."""
        row, folder = self.index.row(key), self.index.folder(key)
        if row is None or folder is None:
            raise CaseGone(f"There is no case {key!r} in this folder: it was removed, or is being written now.")
        if row.status == UNREADABLE:
            raise CaseGone(row.reason)
        return row, folder

    def result(self, folder: Path) -> dict[str, Any]:
        """A case's result.json. Raises Gone where it cannot be read."""
        try:
            return result_in(folder)
        except (OddResult, BadInput) as fault:
            raise CaseGone(f"{fault}; reload in a moment, or run the case again.") from fault

    def render(self, request: Request, name: str, status: int = 200, **context: Any) -> HTMLResponse:
        """A page from a template."""
        text = self.templates.get_template(name).render(
            desk=self,
            csrf=request.state.csrf,
            path_of=path_of,
            trust_words=TRUST_WORDS,
            basis_words=BASIS_WORDS,
            **context,
        )
        return HTMLResponse(text.encode("utf-8", "replace"), status)


def path_of(key: str) -> str:
    """A case's key as part of a web address."""
    return quote(key, safe="/")


def _templates() -> Environment:
    return Environment(
        loader=PackageLoader("flows.desk"), autoescape=select_autoescape(default=True, default_for_string=True),
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
