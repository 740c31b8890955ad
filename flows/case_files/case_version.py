"""The version of a case's folder: a fingerprint of its state on disk, by dates, sizes and numbers of its files."""

from __future__ import annotations

import hashlib
from pathlib import Path

STATES = ("result.json", "facts.yaml", "player.html")
"""Files that change when a case is run again or edited."""


def version_of(folder: Path) -> str:
    """A case's version; a page shows it, so that no edit is applied to an unseen state."""
    found = hashlib.sha256()
    for name in STATES:
        try:
            about = (folder / name).stat()
            found.update(f"{name} {about.st_mtime_ns} {about.st_size} {about.st_ino}\n".encode())
        except OSError:
            found.update(f"{name} -\n".encode())
    return found.hexdigest()[:20]
