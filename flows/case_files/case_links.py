"""Links to a case's pages in Prefect, MLflow and the desk: kept in its folder as links.json.

{"prefect": flow run, "prefect_case": task run, "mlflow": run}. An address that begins with "/" is that of a page whose
server was not known or ends with the command; `resolved` puts the server's address before it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, urlsplit

import psutil

from flows import health
from flows.case_files.case_folder import read_json
from flows.health import Running

FILE = "links.json"
DESK = ".desk"
"""Folder in a results folder that notes the desk that serves it."""
NAMES = ("prefect", "prefect_case", "mlflow")


@dataclass(frozen=True)
class Served:
    """Addresses of pages that are served now, without a slash at the end; "" where they are not."""

    prefect: str = ""
    mlflow: str = ""
    desk: str = ""
    root: Path = Path()
    """The results folder that the desk serves."""

    def case_page(self, folder: Path) -> str:
        """A case's page in the desk."""
        if not self.desk or not folder.is_relative_to(self.root):
            return ""
        return f"{self.desk}/case/{quote(folder.relative_to(self.root).as_posix())}"


def served(out: Path) -> Served:
    """The pages that `make up` and `sgcad desk` serve for a results folder or one above it."""
    there = _running(health.services_folder(out))
    desk = next(((d, folder) for folder in (out, *out.parents[:2]) if (d := _running(folder / DESK).get("desk"))), None)
    return Served(
        prefect=there.get("server", ""), mlflow=there.get("mlflow", ""),
        desk=desk[0] if desk else "", root=desk[1] if desk else Path(),
    )  # fmt: skip


def _running(folder: Path) -> dict[str, str]:
    try:
        return {name: address(service.address) for name, service in health.noted(folder).items() if service.alive()}
    except (
        OSError,
        ValueError,
        TypeError,
        KeyError,
        AttributeError,
        RecursionError,
    ):  # half-written, or of another program
        return {}


@contextmanager
def noted_desk(root: Path, where: str) -> Iterator[None]:
    """Note that a desk serves a results folder while the block lasts."""
    folder, me = root / DESK, os.getpid()
    with suppress(OSError):  # a folder that can only be read has a desk all the same
        folder.mkdir(exist_ok=True)
        Running("desk", me, psutil.Process(me).create_time(), where, "", "").write(folder)
    try:
        yield
    finally:
        if _pid(folder) == me:
            with suppress(OSError):
                (folder / "desk.json").unlink()
                folder.rmdir()


def _pid(folder: Path) -> int:
    with suppress(OSError, ValueError, KeyError, TypeError):
        return health.noted(folder)["desk"].pid
    return 0


def address(given: str) -> str:
    """An http address without a slash at its end; "" for anything else."""
    try:
        parts = urlsplit(given)
    except ValueError:  # such as a broken IPv6 address
        return ""
    return given.rstrip("/") if parts.scheme in ("http", "https") and parts.netloc else ""


# ------------------------------------------------------------------ links.json
def keep(folder: Path, found: Mapping[str, str]) -> None:
    """Add links to a case's folder, if it still exists."""
    partial = folder / f".{FILE}.{os.getpid()}"
    try:
        partial.write_text(json.dumps({**kept(folder), **found}, indent=1) + "\n", encoding="utf-8")
        partial.replace(folder / FILE)
    except OSError:  # a full disk, or the folder is gone
        with suppress(OSError):
            partial.unlink()


def kept(folder: Path) -> dict[str, str]:
    """The links of a case's folder: known names with valid addresses only."""
    found = read_json(folder / FILE)
    return {name: found[name] for name in NAMES if _is_link(found.get(name))}


def _is_link(value: object) -> bool:
    return isinstance(value, str) and (bool(address(value)) or (value.startswith("/") and value[1:2] not in "/\\"))


def resolved(link: str, where: str) -> str:
    """A kept link as an address on the server `where`; "" if the server is not known."""
    if link.startswith("/"):
        return f"{where}{link}" if where else ""
    return where + link[len(address_of(link)) :] if where else link


def address_of(link: str) -> str:
    """The server's part of a link."""
    parts = urlsplit(link)
    return f"{parts.scheme}://{parts.netloc}" if parts.netloc else ""
