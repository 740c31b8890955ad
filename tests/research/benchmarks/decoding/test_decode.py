"""The decoding benchmark runs, measures every arm, and says so where it cannot."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[4]
WITHOUT = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {missing!r}:
            raise ImportError(name)
sys.meta_path.insert(0, Missing())
sys.argv = ["decode", "--size", "tiny", "--rounds", "1", "--reports", "1", "2", "--threads", "1"]
import research.benchmarks.decoding.decode
research.benchmarks.decoding.decode.main()
"""


def bench(missing: tuple[str, ...] = ()) -> str:
    code = WITHOUT.format(missing=set(missing) or {""})
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, timeout=400)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_the_table_has_every_arm() -> None:
    text = bench()
    for arm in (
        "greedy, one row: the base", "cad, both rows in one batch", "cad, two caches",
        "two forwards without cache", "transformers' guidance",
        "cad with grammar and jump-forward", "cad, 2 reports at once", "its repair with draft",
        "its repair without draft", "Floors:",
    ):  # fmt: skip
        assert arm in text
    assert "not measured" not in text


@pytest.mark.slow
def test_without_llguidance_and_pydantic_the_grammar_rows_say_not_measured() -> None:
    text = bench(("llguidance", "pydantic", "PIL"))
    assert "| cad with grammar and jump-forward | not measured |" in text
    assert "Grammar: not measured" in text
    assert "cad, both rows in one batch" in text


@pytest.mark.slow
def test_arms_in_turn_stand_beside_greedy_of_the_same_turn() -> None:
    told = ["--size", "tiny", "--turns", "2", "--threads", "1", "--clock", "process"]
    code = f"from research.benchmarks.decoding.decode import main\nmain({told})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, timeout=400)
    assert done.returncode == 0, done.stderr
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines() if "|" in line]
    rows = {row[0]: row[1:] for row in cells[2:]}
    assert rows["greedy"][1:4] == ["1.000"] * 3
    assert 0.2 < float(rows["cad, both rows in one batch"][1]) < 4
    assert float(rows["cad with grammar and jump-forward"][4]) < 0.6, "model calls a token"
