"""MLflow's database or server: checked in seconds without importing MLflow, and a sqlite file made whole or not at all.

MLflow itself would try to reach a missing server for minutes. It builds the tables of a sqlite file by some forty
migrations, which take seconds; an interrupted one leaves a file that MLflow can neither use nor repair. So the file is
built under another name and renamed, by one process at a time.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import socket
import sqlite3
import tempfile
import urllib.error
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

from sgcad_core.errors import ConfigError
from sgcad_core.system.locks import lock_file

LOCKED_S = 5.0
"""Another batch locks the database for milliseconds; a longer lock belongs to another program."""
CONNECT_S = 10.0
PORTS = {"postgresql": 5432, "mysql": 3306, "mssql": 1433}
ELSEWHERE = "or log elsewhere: --set tracker.database=FILE, --set tracker=jsonl, --set tracker=none"
_HEADER = b"SQLite format 3\0"
_BESIDE = ("", "-wal", "-shm", "-journal")
"""Suffixes of the files that sqlite may leave beside a database."""


def check(uri: str) -> None:
    """Raises ConfigError with the reason if sqlite:///file, http://... or postgresql://... cannot be logged to."""
    if uri.startswith("sqlite:///"):
        check_file(Path(uri.removeprefix("sqlite:///")))
    elif urlsplit(uri).hostname:
        _check_server(uri)


def check_file(file: Path) -> None:
    """Raises ConfigError if a file cannot be written, is no sqlite database, or is locked by another program."""
    try:
        _check_place(file)
        if file.exists() and file.stat().st_size:
            _check_free(file)
    except (OSError, sqlite3.Error) as fault:
        raise ConfigError(f"{file}: {reason(fault)}; {remedy(fault)}, {ELSEWHERE}") from fault


def _check_place(file: Path) -> None:
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder, where MLflow's database would be")
    if file.exists() and not os.access(file, os.R_OK | os.W_OK):
        raise PermissionError(errno.EACCES, "cannot be written")
    folder = file.parent
    if folder.is_dir():
        with tempfile.NamedTemporaryFile(prefix=".sgcad-", dir=folder):  # the journal has to lie beside it
            pass


def _check_free(file: Path) -> None:
    with file.open("rb") as content:
        if content.read(len(_HEADER)) != _HEADER:
            raise sqlite3.DatabaseError("file is not a database")
    with contextlib.closing(sqlite3.connect(file, timeout=LOCKED_S, isolation_level=None)) as found:
        found.execute("BEGIN IMMEDIATE")
        found.execute("ROLLBACK")


def reason(fault: BaseException) -> str:
    """A fault of files and databases in plain words."""
    said = getattr(fault, "strerror", None) or str(fault)
    if is_full(fault):
        return "there is no room left on the disk"
    if "locked" in said:
        return f"another program keeps MLflow's database locked for more than {LOCKED_S:g} s"
    if "not a database" in said:
        return "this is no database of MLflow's"
    if "readonly" in said:
        return "MLflow's database cannot be written"
    return said.strip().splitlines()[0][:200] if said.strip() else type(fault).__name__


def is_full(fault: BaseException) -> bool:
    """Whether a full disk is the cause of a fault."""
    return getattr(fault, "errno", None) == errno.ENOSPC or any(t in str(fault) for t in ("disk is full", "No space"))


def remedy(fault: BaseException) -> str:
    """What the user can do about a fault."""
    if is_full(fault):
        return "make room"
    if "locked" in str(fault):
        return "end that program (`fuser FILE` names it)"
    if isinstance(fault, PermissionError) or "readonly" in str(fault):
        return "make it writable (chmod u+w)"
    return "move it away"


def _check_server(uri: str) -> None:
    """Raises ConfigError without a connection within CONNECT_S; of an http server the health page must answer too."""
    parts = urlsplit(uri)
    kind = parts.scheme.partition("+")[0]
    port = parts.port or {"http": 80, "https": 443}.get(kind) or PORTS.get(kind)
    if port is None or parts.hostname is None:
        return
    try:
        with socket.create_connection((parts.hostname, port), timeout=CONNECT_S):
            pass
        if kind in ("http", "https"):
            with urllib.request.urlopen(f"{uri.rstrip('/')}/health", timeout=CONNECT_S):  # noqa: S310 - the user's
                pass
    except (OSError, ValueError) as fault:
        if isinstance(fault, urllib.error.HTTPError) and fault.code in (401, 403):
            return  # the server is there and wants a login, which MLflow's own client has
        shown, said = re.sub(r"//[^/@]*@", "//", uri), getattr(fault, "reason", None) or fault
        raise ConfigError(
            f"tracker.uri {shown}: no MLflow server answers ({said}); start that server, {ELSEWHERE}"
        ) from fault


# ------------------------------------------------------------------ making a sqlite file
def make_database(file: Path) -> None:
    """Makes a database with MLflow's tables if there is none. Raises OSError and the errors of sqlite and MLflow."""
    if file.exists():
        _usable(file)
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    with lock_file(database_lock(file)):
        if not file.exists():
            partial = file.with_name(f".{file.name}.partial")
            _remove(partial)
            _build(partial)
            os.replace(partial, file)


def database_lock(file: Path) -> Path:
    """The lock file of a database, beside it."""
    return file.with_name(f".{file.name}.lock")


def _usable(file: Path) -> None:
    """Raises OSError for files that MLflow would try to open for minutes."""
    if not file.is_file():
        raise IsADirectoryError("it is no file")
    if not os.access(file, os.R_OK | os.W_OK) or not os.access(file.parent, os.W_OK):
        raise PermissionError("it cannot be written")


def _build(file: Path) -> None:
    import mlflow

    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{file}")
    client.get_experiment("0")
    client._tracking_client.store.engine.dispose()  # else the renamed file stays open under its first name
    with contextlib.closing(sqlite3.connect(file)) as made:  # one file: nothing beside it to rename
        made.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        made.execute("PRAGMA journal_mode=DELETE")


def _remove(file: Path) -> None:
    for suffix in _BESIDE:
        file.with_name(file.name + suffix).unlink(missing_ok=True)
