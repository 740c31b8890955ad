"""The end of a worker process whose parent has ended, however that ended: `kill -9` is not announced."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import os
import threading


def end_with_parent() -> None:
    """End this process of `multiprocessing` as soon as the one that started it has ended; a main process goes on.

    The parent's sentinel is asked, not its number: a first answer of `os.getppid()` is wrong where the parent ended
    while its child still imported.
    """
    if parent := multiprocessing.parent_process():
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True, name="parent").start()


def _end_with(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)
