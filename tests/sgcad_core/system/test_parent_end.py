"""Worker processes end with their parent."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import psutil

from sgcad_core import settings

PARENT = """
    import multiprocessing, sys, time
    from tests.sgcad_core.system.test_parent_end import child

    if __name__ == "__main__":
        process = multiprocessing.get_context("spawn").Process(target=child, args=(float(sys.argv[1]),))
        process.start()
        print(process.pid, flush=True)
        time.sleep(60)
"""


def child(late_s: float) -> None:
    from sgcad_core.system.parent_end import end_with_parent

    time.sleep(late_s)
    end_with_parent()
    time.sleep(60)


def _ends(tmp_path: Path, late_s: float) -> bool:
    """Whether a child is gone soon after its parent was killed; `late_s`: it asks for that so much later."""
    script = tmp_path / "parent.py"
    script.write_text(textwrap.dedent(PARENT), encoding="utf-8")
    around = os.environ | {"PYTHONPATH": str(settings.ROOT)}
    with subprocess.Popen(
        [sys.executable, str(script), str(late_s)], env=around, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        parent.send_signal(signal.SIGKILL)
    deadline = time.monotonic() + 30
    while psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE:
        if time.monotonic() > deadline:
            psutil.Process(pid).kill()
            return False
        time.sleep(0.1)
    return True


def test_a_child_ends_with_its_parent(tmp_path: Path) -> None:
    assert _ends(tmp_path, late_s=0.0)


def test_a_child_whose_parent_ended_before_it_asked_ends_too(tmp_path: Path) -> None:
    assert _ends(tmp_path, late_s=2.0)
