"""How a command ends: its exit code, one message for an error, Ctrl-C, and no process left behind."""

from __future__ import annotations

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress

from flows.terminal import escape_plain
from sgcad_core.errors import SgcadError

PATIENCE_S = 5.0
"""Time limit of an orderly end after Ctrl-C."""
DEATH_S = 2.0
"""Longest wait for killed processes, before their temporary folders are removed."""
at_end: list[Callable[[], object]] = []
"""What is called when a command ends at once, after its processes."""


def guarded(command: Callable[[], object]) -> None:
    """Run a command; every error becomes one message on stderr and an exit code."""
    try:
        command()
    except SgcadError as fault:
        _end(str(fault), 2)
    except KeyboardInterrupt:
        interrupted()
    except Exception as fault:  # noqa: BLE001 - the command line's edge
        from sgcad_core.entry_points import unreadable

        traceback.print_exception(fault)
        said = f"unexpected {type(fault).__name__}: {fault}; `sgcad doctor` checks the installation"
        _end("; ".join([said, *unreadable()]), 1)  # libraries that read all entry points end at a damaged one


def _end(message: str, code: int) -> None:
    sys.stderr.write(f"sgcad: error: {escape_plain(message)}\n")
    leave(code)


def heed_interrupts() -> threading.Event:
    """Let the first Ctrl-C stop the batch in order, within 5 s; the second at once. The event is set by the first."""
    stopped = threading.Event()
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return stopped  # the parent process ignores Ctrl-C

    def first(number: int, frame: object) -> None:
        stopped.set()
        signal.signal(signal.SIGINT, lambda *_: interrupted())
        patience = threading.Timer(PATIENCE_S, interrupted)
        patience.daemon = True
        patience.start()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, first)
    return stopped


def interrupted() -> None:
    """End an interrupted command with 130."""
    sys.stderr.write("sgcad: interrupted; finished cases are kept, run the same command again to go on\n")
    leave(130)


def leave(code: int) -> None:
    """Exit at once: threads may wait for a model, a simulator or a lost server; their processes must end too."""
    import psutil

    from sgcad_core.system import temp_folders

    sys.stdout.flush()
    sys.stderr.flush()
    children = psutil.Process().children(recursive=True)
    for child in children:
        with suppress(psutil.NoSuchProcess):
            child.kill()
    if children:
        psutil.wait_procs(children, timeout=DEATH_S)
    for clear in (temp_folders.remove_own_folders, temp_folders.remove_leftover_folders, *at_end):
        with suppress(Exception):
            clear()
    os._exit(code)
