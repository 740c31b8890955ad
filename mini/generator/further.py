"""More clauses beside those that follow counts of real reports: breadth of English, so that words of reports that
nobody foresaw have been met in some sentence.

`phrases/NAME.txt` holds `== LIST` or `== LIST.key` lines, below each a clause or phrase a line. They only train: the
held-out side of a list stays as it is.
"""

from __future__ import annotations

from collections import defaultdict
from importlib.resources import files
from math import ceil
from typing import Any

SHARE = 0.6
"""How often a choice should fall on what stands in the files, at most; the rest follows the counts."""


def enlarge(name: str, lists: dict[str, Any]) -> None:
    """Put the clauses of a file into the lists of a module, in place.

    What was in a list is repeated so often that it keeps its share. Raises KeyError for a list that there is not.
    """
    for heading, more in _read(name).items():
        key, _, inner = heading.partition(".")
        options: list[str] = lists[key][inner] if inner else lists[key]
        trained = [clause for clause in options if not clause.startswith("~")]
        times = ceil(len(more) * (1 - SHARE) / SHARE / len(trained))
        options += trained * max(0, times - 1) + more


def _read(name: str) -> dict[str, list[str]]:
    found: dict[str, list[str]] = defaultdict(list)
    heading = ""
    text = files("mini.generator").joinpath(f"phrases/{name}.txt").read_text(encoding="utf-8")
    for line in text.splitlines():
        if line.startswith("== "):
            heading = line.removeprefix("== ")
        elif line:
            found[heading].append(line)
    return found
