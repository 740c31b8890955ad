"""More clauses beside those that follow counts of real reports: breadth of English, so that words of reports that
nobody foresaw have been met in some sentence.

`phrases/NAME.txt` and `phrases/training/NAME.txt` hold `== LIST` or `== LIST.key` lines, below each a clause or phrase
a line. The held-out side of a list stays as it is; of a list without one the first serve both sides, those of
`training`, marked with a "+", only train.
"""

from __future__ import annotations

from collections import defaultdict
from importlib.resources import files
from math import ceil
from typing import Any

from mini.generator.grammar import TRAINS, families

SHARE = 0.6
"""How often a choice should fall on what stands in the files, at most; the rest follows the counts."""


def enlarge(name: str, lists: dict[str, Any]) -> None:
    """Put the clauses of the files of a name into the lists of a module, in place.

    What was in a list is repeated so often that it keeps its share. Raises KeyError for a list that there is not.
    """
    counted: dict[str, list[str]] = {}
    for heading, more in _read(name).items():
        options = _listed(lists, heading)
        counted[heading] = families(options, False)
        times = round(_wanted(more, counted[heading]))
        options += counted[heading] * max(0, times - 1) + more
    for heading, more in _read(f"training/{name}").items():
        options = _listed(lists, heading)
        trained = counted.get(heading) or families(options, False)
        again = trained * ceil(_wanted(more, trained))
        options += [TRAINS + clause for clause in again + more]


def _listed(lists: dict[str, Any], heading: str) -> list[str]:
    key, _, inner = heading.partition(".")
    found: list[str] = lists[key][inner] if inner else lists[key]
    return found


def _wanted(more: list[str], counted: list[str]) -> float:
    """How often the counted clauses must stand beside further ones to keep their share."""
    return len(more) * (1 - SHARE) / SHARE / len(counted)


def _read(name: str) -> dict[str, list[str]]:
    found: dict[str, list[str]] = defaultdict(list)
    heading, file = "", files("mini.generator").joinpath(f"phrases/{name}.txt")
    if name.startswith("training/") and not file.is_file():
        return found
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("== "):
            heading = line.removeprefix("== ")
        elif line:
            found[heading].append(line)
    return found
