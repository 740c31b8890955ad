"""Noise of typing: what each kind does to a text, and that reports are read through it."""

import gzip
import json
import random
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from research.benchmarks.texts import typing_noise
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.typos import one_slip
from tests.effort import spread

REPORTS = (
    "Vehicle 1 was traveling northbound in the right lane behind Vehicle 2. Vehicle 2 slowed for stopped traffic. "
    "The front of Vehicle 1 struck the rear of Vehicle 2.",
    "V1 was traveling westbound on a two-lane road. V2 was traveling eastbound and was turning left at the "
    "intersection. The front of V1 contacted the right side of V2. V2 rotated and came to rest on the roadway.",
    "V1 was traveling south. V1 departed the right side of the road and the front of V1 struck a tree.",
)


@given(st.text("abcdefghijklmnopqrstuvwxyz", min_size=4, max_size=12), st.integers(0, 999))
def test_a_slip_is_one_edit_and_keeps_the_first_letter(word: str, seed: int) -> None:
    slipped = typing_noise.slip(word, random.Random(seed))
    assert slipped == word or one_slip(slipped, word)
    assert slipped[0] == word[0]


@pytest.mark.parametrize(("report", "kind"), spread(product(REPORTS, typing_noise.KINDS), 4))
def test_a_report_is_read_through_noise(kind: str, report: str) -> None:
    def told(text: str) -> dict[str, object]:
        return {f.field: f.value for f in read(text).facts if f.field.startswith(("vehicles", "contacts"))}

    plain = told(report)
    lost = 0
    for seed in range(8):
        noisy = told(typing_noise.KINDS[kind](report, random.Random(seed)))
        lost += sum(noisy.get(field) != value for field, value in plain.items())
    assert lost <= 0.08 * 8 * len(plain)  # letters lost in words of three or two letters cannot be put back


def test_the_command_prints_a_line_a_kind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    road = {"lanes_total": 2, "lanes_from_text": 2, "lanes_scope": "both_directions", "flow": "two_way_undivided",
            "twltl": False, "control": "none", "told": {"control": False}}  # fmt: skip
    case = {
        "id": "a-1", "text": REPORTS[0], "blind": False,
        "network": {"intersections": 0, "told": {"intersection": True}, "relative_heading_v2_minus_v1": 0,
                    "control": "none", "roads": [road]},
        "vehicles": [{"id": "V1", "manoeuvre_resolved": "straight", "told": True}],
        "events": [{"kind": "collision", "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "back"}],
    }  # fmt: skip
    pool = tmp_path / "pool.jsonl.gz"
    with gzip.open(pool, "wt") as file:
        file.write("\n".join(json.dumps(case | {"id": f"a-{n}", "blind": n == 3}) for n in range(4)))
    typing_noise.main(["--pool", str(pool)])
    out = capsys.readouterr().out
    assert out.startswith("3 seen, 1 blind")
    assert all(out.count(kind) == 2 for kind in typing_noise.KINDS)
    assert "1.000" in out.splitlines()[2]
