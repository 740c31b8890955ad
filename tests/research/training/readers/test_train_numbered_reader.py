"""Learning from coded numbered reports: rows that are made, a reader that finds the pattern, lines without any text."""

from __future__ import annotations

import gzip
import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from research.rows import numbered_rows
from research.rows.numbered_rows import Row, codes_of, lines_of, part_of, rows_of
from research.training.readers import train_numbered_reader
from research.training.readers.train_numbered_reader import crossed, judged, kept_rows, learn, say, taught
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.learned_reader import hashed
from sgcad_core.reading.second_reader.numbered import numbered_reader

TEXT = "V1 was traveling east on a four lane road. V2 was stopped. The front of V1 struck the back of V2."


def line(id: str = "ciss-1", text: str = TEXT, **more: Any) -> dict[str, Any]:
    road = {"vehicle": "V1", "lanes_total": 4, "lanes_scope": "both_directions", "twltl": False, "lanes_from_text": 4,
            "flow": "two_way_undivided", "control": "none", "told": {"control": False}}  # fmt: skip
    network = {
        "intersections": 0,
        "told": {"intersection": True},
        "relative_heading_v2_minus_v1": 0,
        "roads": [road],
        "control": "none",
    }
    vehicles = [{"id": "V1", "told": True, "manoeuvre_resolved": "straight"},
                {"id": "V2", "told": True, "manoeuvre_resolved": "stopped"}]  # fmt: skip
    event = {"kind": "collision", "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "back"}
    return {"id": id, "text": text, "network": network, "vehicles": vehicles, "events": [event], "blind": False} | more


def rows(count: int, part: str = "taught", begin: int = 0) -> list[Row]:
    """Questions of which the rules miss all that are told in a word that they do not know."""
    draw, found = random.Random(begin), []
    for n in range(count):
        stands = draw.random() < 0.3
        words = {*draw.sample([f"M:w{k}" for k in range(20)], 10), *(["M:halted"] if stands else [])}
        seen = hashed(words), hashed(["own=straight"])
        found.append(
            Row(f"r{begin + n}", part, "maneuver.V1", *seen, "straight", 0.0, ("stopped" if stands else "straight",))
        )
    return found


def test_codes_say_what_may_be_answered() -> None:
    codes = codes_of(line(), read(TEXT))
    assert codes["maneuver.V2"] == ("stopped",)
    assert codes["maneuver.V1"][0] == "straight"
    assert (codes["junction"], codes["turned.V2"], codes["lanes.V1"]) == (("no",), ("0",), ("both4",))
    assert (codes["area.V1"], codes["area.V2"], codes["met.V1"]) == (("front",), ("back",), ("vehicle",))


def test_codes_that_quarrel_with_the_text_or_are_not_told_teach_nothing() -> None:
    quarrel = line(code_conflicts=["relative heading: the text's directions differ from the crash types"])
    assert "turned.V2" not in codes_of(quarrel, read(TEXT))
    untold = line(vehicles=[{"id": "V2", "told": False, "manoeuvre_resolved": "stopped"}])
    assert not [key for key in codes_of(untold, read(TEXT)) if key.startswith(("maneuver", "met"))]


def test_lines_become_rows_without_words_and_come_back_from_their_file(tmp_path: Path) -> None:
    pool = tmp_path / "pool.jsonl.gz"
    with gzip.open(pool, "wt", encoding="utf-8") as out:
        out.write("\n".join(json.dumps(line(f"ciss-{n}", blind=n == 2)) for n in range(3)))
    found = kept_rows(tmp_path / "rows.npz", pool, None, 1)
    assert {one.part for one in found if one.id == "ciss-2"} == {"blind"}
    assert all(one.words.dtype == np.uint32 for one in found)
    again = kept_rows(tmp_path / "rows.npz", tmp_path / "gone", None, 1)
    assert [(a.field, a.rule, a.told, a.allowed, a.may) for a in again] == [
        (b.field, b.rule, b.told, b.allowed, b.may) for b in found
    ]
    assert all(
        (a.words == b.words).all() and (a.readings == b.readings).all() for a, b in zip(again, found, strict=True)
    )
    assert len(list(lines_of(pool))) == 3


def test_a_part_follows_from_the_id_and_one_in_ten_is_set_apart() -> None:
    parts = [part_of({"id": f"x{n}", "blind": False}) for n in range(2000)]
    assert parts.count("apart") / len(parts) == pytest.approx(1 / numbered_rows.APART_OF, abs=0.03)
    assert part_of({"id": "x1", "blind": True}) == "blind"


def test_what_the_rules_miss_is_found_in_rows_set_apart() -> None:
    ((name, kind, kept, lines),) = learn([*rows(400), *rows(200, "apart", 1000), *rows(100, "blind", 3000)])
    assert (name, kept) == ("maneuver", True)
    assert "both 1.0000" in lines[0]
    assert lines[1].startswith("maneuver, blind: n 100")
    assert kind.field.change[1] >= 0


def test_a_judge_never_decides_rows_that_taught_it() -> None:
    some = judged(taught(rows(300)), rows(100, "apart", 500))
    ends = crossed(some)
    assert {id(one) for one, _ in ends} == {id(one) for one in some}


def test_a_field_in_which_nothing_is_mended_is_left_to_the_rules() -> None:
    even = [one._replace(rule=one.allowed[0]) for one in rows(200)]
    apart = [one._replace(rule=one.allowed[0], part="apart") for one in rows(100, "apart", 900)]
    assert [kept for _, _, kept, _ in learn([*even, *apart])] == [False]


def test_weights_say_what_the_readers_said(tmp_path: Path) -> None:
    some = rows(200)
    kind = taught(some)
    numbered_reader.save({"maneuver": kind}, tmp_path / "w.npz")
    again = numbered_reader.load(tmp_path / "w.npz")["maneuver"]
    both, alone = say(kind, some[:5])
    for n, one in enumerate(some[:5]):
        found = numbered_reader.shares(again, one.words, one.readings)
        assert np.allclose(found[0], both[n], atol=0.05)
        assert np.allclose(found[1], alone[n], atol=0.05)


def test_the_command_writes_weights_and_totals(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    numbered_rows.save([*rows(300), *rows(100, "apart", 700)], tmp_path / "rows.npz")
    out = tmp_path / "w.npz"
    train_numbered_reader.main(["none", "--rows", str(tmp_path / "rows.npz"), "--out", str(out)])
    assert set(numbered_reader.load(out)) == {"maneuver"}
    assert "M:" not in capsys.readouterr().out


def test_rows_of_a_line_are_those_that_codes_answer() -> None:
    fields = {one.field for one in rows_of(line())}
    assert {"maneuver.V1", "maneuver.V2", "area.V1", "junction", "turned.V2", "lanes.V1"} <= fields
    assert "lanes.V2" not in fields
