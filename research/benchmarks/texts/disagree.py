"""Where do the rules' reading and the codes of real reports disagree? Shares by field, and wordings that go with it.

    python -m research.benchmarks.texts.disagree --pool POOL.jsonl[.gz] [--limit N] [--seed S] [--field FIELD]
                                                 [--most K] [--rows FILE.jsonl]

Reads every narrative by the rules alone, in two processes, plans nothing and simulates nothing, and holds the roads
and the behavior that come of it against the codes (research/benchmarks/texts/coded_cases.py). `--limit` takes a
sample, the same one for the same seed. A line with `"blind": true` is counted and nothing else: only its shares are
printed, beside those of the seen lines. Then, for each field, the commonest pairs of a coded and a read value, and
runs of one to three words that stand oftener in reports that disagree than in others (log odds with a Dirichlet
prior, in standard deviations), with the rules of the facts concerned and a few sentences. `--rows` keeps a line for
every seen verdict, to compare two states of the rules.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import random
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

from research.benchmarks.texts.coded_cases import FIELDS, Verdict, drawn, kind_of, verdicts

PROCESSES = 2
_WORD = re.compile(r"[a-z]+(?:-[a-z]+)*|\d+")
_VEHICLE = re.compile(r"\b(?:vehicle\s*#?\s*|v)\d+('s)?")
_LONGEST = 3
_LEAST = 5
"""Reports that a run of words must stand in."""
_LEAST_SURE = 2.5
_PRIOR = 0.5
_SHOWN = 3


class Row(NamedTuple):
    """A narrative with what is wrong and right of its reading."""

    id: str
    text: str
    blind: bool
    verdicts: Sequence[Verdict]


def sample(pool: Path, limit: int | None, seed: int) -> list[dict[str, Any]]:
    """Lines of a pool, all of them or so many as the seed draws."""
    opened = gzip.open if pool.suffix == ".gz" else open
    with opened(pool, "rt", encoding="utf-8") as file:
        lines = [json.loads(line) for line in file if line.strip()]
    return lines if limit is None or limit >= len(lines) else random.Random(seed).sample(lines, limit)


def judged(case: Mapping[str, Any]) -> Row:
    """A line of the pool read and compared."""
    return Row(case["id"], case["text"], bool(case.get("blind")), verdicts(case, drawn(case["text"])))


def shares(rows: Sequence[Row]) -> Iterator[str]:
    """A line for each field: the shares right of the seen and of the blind reports, and their numbers."""
    yield f"{'field':18s} {'seen':>7s} {'n':>6s}   {'blind':>7s} {'n':>6s}"
    for field in FIELDS:
        cells = []
        for blind in (False, True):
            marks = [v.right for row in rows if row.blind == blind for v in row.verdicts if v.field == field]
            cells.append(f"{sum(marks) / len(marks):7.3f} {len(marks):6d}" if marks else f"{'-':>7s} {0:6d}")
        yield f"{field:18s} {cells[0]}   {cells[1]}"


# ------------------------------------------------------------------ clusters
class Cluster(NamedTuple):
    """A run of words that goes with disagreement in one field."""

    words: str
    sure: float
    wrong: int
    agree: int
    example: tuple[str, ...]


def clusters(rows: Sequence[Row], field: str) -> list[Cluster]:
    """The runs of words of disagreeing seen reports, the surest and largest first; a run within a taken one is left."""
    marks = {row.id: [v.right for v in row.verdicts if v.field == field] for row in rows if not row.blind}
    wrong, agree = Counter[str](), Counter[str]()
    holding = defaultdict(list)
    for row in (row for row in rows if marks.get(row.id)):
        right = all(marks[row.id])
        for run in runs(row.text):
            (agree if right else wrong)[run] += 1
            if not right:
                holding[run].append(row.id)
    found = [Cluster(run, z, n, agree[run], tuple(holding[run])) for run, n in wrong.items()
             if n >= _LEAST and (z := log_odds(n, wrong, agree[run], agree)) >= _LEAST_SURE]  # fmt: skip
    return _apart(sorted(found, key=lambda c: -c.sure * math.sqrt(c.wrong)))


def _apart(found: Iterable[Cluster]) -> list[Cluster]:
    """Those whose reports are not mostly those of a larger one."""
    kept: list[Cluster] = []
    for one in found:
        mine = set(one.example)
        if all(len(mine & set(other.example)) < 0.6 * len(mine) for other in kept):
            kept.append(one)
    return kept


def runs(text: str) -> set[str]:
    """The runs of words of a text, vehicles without their numbers."""
    words = _WORD.findall(_VEHICLE.sub("vn", text.lower()))
    return {" ".join(words[i : i + n]) for n in range(1, _LONGEST + 1) for i in range(len(words) - n + 1)}


def log_odds(n: int, wrong: Counter[str], m: int, agree: Counter[str]) -> float:
    """How many standard deviations a run is commoner among the disagreeing (Monroe et al. 2008, a flat prior)."""
    all_wrong, all_agree = max(wrong.total(), 1), max(agree.total(), 1)
    odds = math.log((n + _PRIOR) / (all_wrong - n + _PRIOR)) - math.log((m + _PRIOR) / (all_agree - m + _PRIOR))
    return odds / math.sqrt(1 / (n + _PRIOR) + 1 / (m + _PRIOR))


def told(rows: Sequence[Row], field: str, most: int) -> Iterator[str]:
    """What disagrees in a field, for reading: seen reports only."""
    seen = {row.id: row for row in rows if not row.blind}
    bad = [(row, v) for row in seen.values() for v in row.verdicts if v.field == field and not v.right]
    if not bad:
        return
    yield f"\n===== {field}: {len(bad)} disagree"
    pairs = Counter((kind_of(v.want), kind_of(v.got)) for _, v in bad)
    yield from (f"{n:5d}  coded {want} | read {got}" for (want, got), n in pairs.most_common(most))
    for cluster in clusters(rows, field)[:most]:
        yield f"--- {cluster.words!r}: {cluster.wrong} disagree, {cluster.agree} agree, {cluster.sure:.1f} sd"
        some = [(seen[id], v) for id in cluster.example for v in seen[id].verdicts if v.field == field and not v.right]
        rules = Counter(rule for _, v in some for rule in v.rules)
        yield "    rules: " + ", ".join(f"{rule} {n}" for rule, n in rules.most_common(5))
        for row, v in some[:_SHOWN]:
            yield f"    {row.id}: coded {v.want} | read {v.got}\n        {_sentence(row.text, cluster.words)}"


def _sentence(text: str, words: str) -> str:
    """The sentence of a text that has a run of words."""
    sentences = re.split(r"(?<=[.!?])\s+", text)
    return next((s for s in sentences if words in runs(s)), text)


def kept_rows(rows: Iterable[Row]) -> Iterator[str]:
    """A line of JSON for each verdict on a seen report."""
    for row in rows:
        if not row.blind:
            yield from (json.dumps({"id": row.id, **v._asdict()}) for v in row.verdicts)


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pool", type=Path, required=True)
    parser.add_argument("--limit", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--field", choices=FIELDS, help="print the clusters of this field alone")
    parser.add_argument("--most", type=int, default=12, help="clusters and pairs of values a field")
    parser.add_argument("--rows", type=Path, help="keep the verdicts on seen reports here")
    options = parser.parse_args(arguments)
    with Pool(PROCESSES) as pool:
        rows = pool.map(judged, sample(options.pool, options.limit, options.seed), chunksize=20)
    if options.rows:
        options.rows.write_text("\n".join(kept_rows(rows)) + "\n", encoding="utf-8")
    lines = [*shares(rows)]
    for field in (options.field,) if options.field else FIELDS:
        lines += told(rows, field, options.most)
    print("\n".join(lines))  # noqa: T201 - a command prints


if __name__ == "__main__":
    main()
