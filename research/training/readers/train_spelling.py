"""Counts the words of real reports, by which typing errors are told from words.

    python -m research.training.readers.train_spelling POOL.jsonl[.gz] [POOL ...] [--known FOLDER ...] [--out FILE]

Lines that are blind are left out. A word to mend towards stands in the language data and in `USED` reports. A word is
known if `COMMON` files (.txt, .md, .rst, .py) under the folders use it, or if `KNOWN_IN` reports or files do, unless
it is one slip from a word that is `SLIP` times commoner and no inflection of it: then it is a common slip itself.
Known words are kept as hashes. Printed are the numbers of words and what becomes of the words of blind lines that are
not known.
"""

from __future__ import annotations

import argparse
import gzip
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from sgcad_core.reading.language.data import language, vocabulary
from sgcad_core.reading.text.typos import SHORTEST, WEIGHTS, Spelling, hashed, one_slip, save

USED = 12
KNOWN_IN = 3
COMMON = 8
SLIP = 150
_WORD = re.compile(r"[a-z]{2,}")
_ENDINGS = ("s", "es", "d", "ed", "ing", "ly", "er", "r", "y", "n", "e")
_SLIPS = ("typos.",)
_MISSPELT = ("typo", "text.typo", "shorthand", "spelling")
_TEXTS = (".txt", ".md", ".rst", ".py")


def reports(pools: Iterable[Path], blind: bool = False) -> Iterator[str]:
    """The narratives of the lines that are not blind, or of those that are."""
    for pool in pools:
        opened = gzip.open if pool.suffix == ".gz" else open
        with opened(pool, "rt", encoding="utf-8") as file:
            for line in filter(str.strip, file):
                case = json.loads(line)
                if bool(case.get("blind")) == blind:
                    yield case.get("text") or case.get("narrative") or ""


def counted(texts: Iterable[str]) -> Counter[str]:
    """In how many texts each word stands."""
    return Counter(word for text in texts for word in set(_WORD.findall(text.lower())))


def words_of_rules(misspelt: bool = False) -> set[str]:
    """The words of the language data, in word classes and examples; with the `misspelt` ones that have rules."""
    left_out = _SLIPS if misspelt else (*_SLIPS, *_MISSPELT)
    rules = (record for record in language().rules.values() if not record.id.startswith(left_out))
    texts = [text for record in rules for text in record.examples]
    for name, one in ((name, one) for name, one in vocabulary().classes.items() if not name.startswith(left_out)):
        texts += [*one.examples, *(str(word) for word in one.words), name]
    return {word for text in texts for word in _WORD.findall(text.lower())}


def targets_of(counts: Counter[str]) -> dict[str, int]:
    """The words to mend towards with their counts: words of the rules that enough reports use, none a slip itself."""
    used = {word: counts[word] for word in sorted(words_of_rules()) if counts[word] >= USED}
    return {word: n for word, n in used.items() if not is_slip(word, n, used)}


def is_slip(word: str, n: int, targets: dict[str, int]) -> bool:
    """Whether a word is one slip from a far commoner one and no form of it."""
    return any(
        m >= SLIP * max(n, 1) and len(word) >= SHORTEST - 1 and len(target) >= SHORTEST and word[0] == target[0]
        and abs(len(word) - len(target)) <= 1 and one_slip(word, target) and not forms(word, target)
        for target, m in targets.items()
    )  # fmt: skip


def forms(a: str, b: str) -> bool:
    """Whether two words are forms of one: plane, planes."""
    long, short = (a, b) if len(a) > len(b) else (b, a)
    return any(long == short + end or (short.endswith("e") and long == short[:-1] + end) for end in _ENDINGS)


def main(arguments: Sequence[str] | None = None) -> None:
    """Count, keep, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pools", type=Path, nargs="+")
    parser.add_argument("--known", type=Path, nargs="*", default=[])
    parser.add_argument("--out", type=Path, default=WEIGHTS)
    options = parser.parse_args(arguments)
    counts = counted(reports(options.pools))
    targets = targets_of(counts)
    files = (f for folder in options.known for f in folder.rglob("*") if f.suffix in _TEXTS and f.is_file())
    elsewhere = counted(f.read_text(encoding="utf-8", errors="ignore") for f in files)
    used = {word: max(counts[word], elsewhere[word]) for word in counts.keys() | elsewhere.keys()}
    known = {word for word, n in used.items()
             if elsewhere[word] >= COMMON or (n >= KNOWN_IN and not is_slip(word, counts[word], targets))}  # fmt: skip
    known |= words_of_rules(misspelt=True)
    save(targets, known, options.out)
    made = Spelling({word: float(n) for word, n in targets.items()}, frozenset(map(hashed, known)))
    unknown = Counter(w for text in reports(options.pools, blind=True) for w in _WORD.findall(text.lower())
                      if w not in targets and w not in known)  # fmt: skip
    mends = sum(n for word, n in unknown.items() if made.meant(word))
    told = f"{len(targets)} words to mend towards, {len(known)} known"
    print(f"{told}; of {unknown.total()} unknown words in blind lines {mends} are mended")  # noqa: T201


if __name__ == "__main__":
    main()
