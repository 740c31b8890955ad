"""MLflow's sqlite file, made whole or not at all.

Its tables are built by some forty migrations, which take seconds; an interrupted one leaves a database that MLflow can
neither use nor mend. So it is built under another name and renamed, by one process at a time. Knows MLflow's client.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from pathlib import Path

from sgcad_core.system.locks import lock_file

_BESIDE = ("", "-wal", "-shm", "-journal")
"""What sqlite may leave of one database."""


def make_database(file: Path) -> None:
    """Make a database with MLflow's tables where there is none. Raises OSError, what sqlite and MLflow raise."""
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
    """Raises OSError for what MLflow would try to open for minutes."""
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
