"""What state of a case a page shows, in a word: two states differ in it, so that no edit is laid over an unseen one."""

from __future__ import annotations

import hashlib
from pathlib import Path

from flows.desk.index import RESULT

STATES = (RESULT, "facts.yaml", "player.html")
"""Files that change when a case is run again or mended."""


def version_of(folder: Path) -> str:
    """A fingerprint of the case as it stands on disk."""
    found = hashlib.sha256()
    for name in STATES:
        try:
            about = (folder / name).stat()
            found.update(f"{name} {about.st_mtime_ns} {about.st_size} {about.st_ino}\n".encode())
        except OSError:
            found.update(f"{name} -\n".encode())
    return found.hexdigest()[:20]
