"""How much of a real report's reading is left when it is typed badly? Shares by kind of noise, against the codes.

    python -m research.benchmarks.texts.typing_noise --pool POOL.jsonl[.gz] [--limit 300] [--seed S]

Every narrative is read as it is and once for each kind of noise (`KINDS`), by the rules alone; roads and behavior are
held against the codes as in `research.benchmarks.texts.disagree`. A line of shares a kind: first of the seen lines,
then of the blind ones, of which nothing else is printed. Noise comes from the report's id: it is always the same.
"""

from __future__ import annotations

import argparse
import random
import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from multiprocessing import Pool
from pathlib import Path
from typing import Any

from research.benchmarks.texts.coded_cases import FIELDS, drawn, verdicts
from research.benchmarks.texts.disagree import PROCESSES, Row, sample

_KEYS = ("qwertyuiop", "asdfghjkl", "zxcvbnm")
_LOOKALIKES = str.maketrans("olsb", "0158")
_SHORTEST = 4
"""Letters of a word that gets a slip; shorter ones are other words at once."""

Noise = Callable[[str, random.Random], str]


def slip(word: str, chance: random.Random) -> str:
    """A word with one slip inside: letters exchanged, one left out, typed twice, or its neighbor on the keys."""
    if len(word) < _SHORTEST or not (word.isascii() and word.isalpha()):
        return word
    i = chance.randrange(1, len(word) - 1)
    kind = chance.choice(("exchanged", "left out", "twice", "neighbor"))
    if kind == "exchanged":
        return word[:i] + word[i + 1] + word[i] + word[i + 2 :]
    if kind == "left out":
        return word[:i] + word[i + 1 :]
    if kind == "twice":
        return word[:i] + word[i] + word[i:]
    return word[:i] + chance.choice(beside(word[i])) + word[i + 1 :]


def beside(letter: str) -> str:
    """The letters beside a letter on the keys."""
    row = next((row for row in _KEYS if letter.lower() in row), "")
    at = row.find(letter.lower())
    return row[max(0, at - 1) : at] + row[at + 1 : at + 2] if row else ""


def slips(text: str, chance: random.Random, share: float = 0.04) -> str:
    """A share of the words with a slip each."""
    return " ".join(slip(word, chance) if chance.random() < share else word for word in text.split(" "))


def scanned(text: str, chance: random.Random) -> str:
    """Each letter that has a lookalike among the digits is it in one of a hundred places."""
    return "".join(c.translate(_LOOKALIKES) if chance.random() < 0.01 else c for c in text)


def glued(text: str, chance: random.Random) -> str:
    """One space of fifty is missing."""
    return re.sub(" ", lambda _: "" if chance.random() < 0.02 else " ", text)


def lost_letters(text: str, chance: random.Random) -> str:
    """One letter of a hundred is missing, in words of any length."""
    return "".join("" if c.isalpha() and chance.random() < 0.01 else c for c in text)


def broken_lines(text: str, chance: random.Random) -> str:
    """A line ends at one space of ten."""
    return re.sub(" ", lambda _: "\n" if chance.random() < 0.1 else " ", text)


KINDS: Mapping[str, Noise] = {
    "as written": lambda text, _: text,
    "slips in 4 % of the words": slips,
    "slips in 10 % of the words": partial(slips, share=0.1),
    "digits for letters": scanned,
    "spaces lost": glued,
    "letters lost": lost_letters,
    "lines broken": broken_lines,
    "no commas": lambda text, _: text.replace(",", ""),
    "capitals": lambda text, _: text.upper(),
    "small letters": lambda text, _: text.lower(),
}


def judged(kind: str, case: Mapping[str, Any]) -> Row:
    """A line of the pool with one kind of noise, read and compared."""
    text = KINDS[kind](case["text"], random.Random(f"{kind} {case['id']}"))
    return Row(case["id"], text, bool(case.get("blind")), verdicts(case, drawn(text)))


def table(rows: Mapping[str, Sequence[Row]], blind: bool) -> Iterator[str]:
    """A line for each kind: the share right of each field, of the seen or the blind reports."""
    yield f"{'blind' if blind else 'seen':28s}" + "".join(f"{field[:11]:>12s}" for field in FIELDS)
    for kind, read in rows.items():
        marks = defaultdict(list)
        for verdict in (v for row in read if row.blind == blind for v in row.verdicts):
            marks[verdict.field].append(verdict.right)
        cells = (f"{sum(marks[f]) / len(marks[f]):12.3f}" if marks[f] else f"{'-':>12s}" for f in FIELDS)
        yield f"{kind:28s}" + "".join(cells)


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pool", type=Path, required=True)
    parser.add_argument("--limit", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    cases = sample(options.pool, options.limit, options.seed)
    with Pool(PROCESSES) as pool:
        rows = {kind: pool.map(partial(judged, kind), cases, chunksize=10) for kind in KINDS}
    blind = sum(bool(case.get("blind")) for case in cases)
    print("\n".join([f"{len(cases) - blind} seen, {blind} blind", *table(rows, False), "", *table(rows, True)]))  # noqa: T201


if __name__ == "__main__":
    main()
