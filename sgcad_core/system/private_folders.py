"""Access to results: reports tell of persons, so other users get none.

A results folder is made for its user alone (0700); what is put into it opens as far as the folder around it, but never
to others. So one `chmod` of the results folder shares all of it with a group.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

OTHERS = stat.S_IRWXO


def deny_others() -> None:
    """From now on nothing that this process or its children make can be read by other users."""
    os.umask(os.umask(OTHERS) | OTHERS)


def open_as_parent(folder: Path) -> None:
    """Give a folder, made for its user alone, the access of the folder around it, without others."""
    folder.chmod((folder.parent.stat().st_mode & ~OTHERS & 0o777) | stat.S_IRWXU)
