"""Lock files between processes, by the library filelock."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock


@contextmanager
def lock_file(path: Path, timeout_s: float = -1) -> Iterator[None]:
    """Holds a lock file for the block, after its present holder; -1: waits without limit.

    The lock ends with its process. The file is removed at the end of the block: processes that wait for it notice and
    create it again. Raises OSError: the file cannot be created, or the time is over (`filelock.Timeout`).
    """
    with FileLock(path, timeout=timeout_s):
        try:
            yield
        finally:
            path.unlink(missing_ok=True)
