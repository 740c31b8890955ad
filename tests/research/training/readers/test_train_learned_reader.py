"""Learning where the rules err: rows that are made, a reader that finds the pattern, a judge that is calibrated."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from research.rows.reader_rows import Row, row, target
from research.training.readers import train_learned_reader
from research.training.readers.train_learned_reader import Judge, judged, learn, taught
from sgcad_core.reading.second_reader import learned_reader
from tests.research.benchmarks.texts.test_fuse_weights import pool

WORDS = [f"U:w{n}" for n in range(20)] + [f"U:w{n}_w{n + 1}" for n in range(20)]


def rows(count: int, begin: int = 0) -> list[Row]:
    """Reports in which the rules miss every vehicle that backs and is told so in other words than they know."""
    draw, found = random.Random(begin), []
    for n in range(begin, begin + count):
        backs, areas = draw.random() < 0.3, draw.choice((("front", "back"), ("back", "front")))
        seen = {*draw.sample(WORDS, 12), *(["U:reversed", "U:it_reversed"] if backs else [])}
        said = {"subject": "straight", "subject_area": areas[0], "other_area": areas[1]}
        codes = {
            "subject": ("backing",) if backs else ("straight",), "subject_area": (areas[0],), "other_area": (areas[1],),
        }  # fmt: skip
        says = frozenset(f"{key}={value}" for key, value in said.items())
        found.append(Row(f"sgo-{n}", frozenset(seen), says, said, frozenset(), codes))
    return found


def test_what_the_rules_miss_is_found_in_reports_set_apart() -> None:
    made, lines = learn(rows(200), rows(80, 1000), 0.6, 4)
    assert set(made.fields) == {"subject"}, "a field in which nothing is mended is not kept"
    apart = next(line for line in lines if line.startswith("subject, validation sgo"))
    assert "both 1.000" in apart
    assert " -0 " in apart
    assert 0 < made.least_known <= 1


def test_the_rules_value_is_what_is_to_be_said_where_it_is_told_and_codes_allow_it() -> None:
    may = {"subject": ("straight", "slowing")}
    one = rows(1)[0]._replace(values={"subject": "slowing"}, told=frozenset({"subject"}), allowed=may)
    assert target(one, "subject") == ("slowing",)
    assert target(one._replace(told=frozenset()), "subject") == ("straight", "slowing")
    assert target(one._replace(values={"subject": "backing"}), "subject") == ("straight", "slowing")
    assert one.right("subject", "overtaking"), "what may look the same is no error of the rules"


def test_a_judge_is_as_sure_as_it_is_right() -> None:
    some = judged(taught(rows(200)), "subject", rows(100, 500))
    ends = [Judge.of(some).decides(one, 0.6) for one in some]
    assert all(right for _, right, _ in ends)
    assert np.mean([p for p, _, _ in ends]) > 0.9


def test_weights_say_what_the_readers_said(tmp_path: Path) -> None:
    some = rows(150)
    readers = taught(some)
    made, _ = learn(some, rows(30, 900), 0.6, 3)
    learned_reader.save(made, tmp_path / "w.npz")
    field = learned_reader.load(tmp_path / "w.npz").fields["subject"]
    both, alone = readers.say("subject", some[:5])
    for n, one in enumerate(some[:5]):
        at = learned_reader.known(one.words, made.word_hashes), learned_reader.known(one.readings, made.reading_hashes)
        again = learned_reader.probabilities(field, *at)
        assert np.allclose(again[0], both[n], atol=0.03)
        assert np.allclose(again[1], alone[n], atol=0.03)


def test_reports_become_rows_and_what_cannot_be_drawn_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from research.rows.coded_incidents import of_pool

    made = [row(one) for one in of_pool(pool(tmp_path / "pool.jsonl", 6))]
    known = [one for one in made if one]
    assert known
    assert all(one.words and one.readings for one in known)
    assert row(of_pool(tmp_path / "pool.jsonl")[0]._replace(text="Nothing happened to anybody on that day.")) is None
    assert set(train_learned_reader.FIELDS) >= set(known[0].allowed)
