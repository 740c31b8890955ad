"""A deterministic share of the fuzzing, and that it notices what it is for."""

import pytest

from research.benchmarks.fuzz import trying
from research.benchmarks.fuzz.kinds import KINDS, Kind
from research.benchmarks.fuzz.making import report
from research.benchmarks.fuzz.trying import sample, tried


@pytest.mark.parametrize("name", [name for name in KINDS if name != "case"])
def test_no_input_ends_otherwise_than_told(name, tmp_path):
    assert [f for seed in range(25) if (f := tried(KINDS[name], seed, tmp_path)).wrong] == []


def test_no_report_ends_a_case_by_a_bug(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert [f for seed in range(12) if (f := tried(KINDS["case"], seed, tmp_path)).wrong] == []


def test_an_input_is_a_function_of_its_seed():
    assert sample(KINDS["text"], 5) == sample(KINDS["text"], 5)
    assert len({sample(KINDS["text"], seed) for seed in range(20)}) == 20


def test_an_error_of_nobodys_and_a_slow_reader_are_found(tmp_path, monkeypatch):
    def stumbles(content, place):
        raise KeyError("V5")

    assert "KeyError: 'V5'" in tried(Kind("bad", report, stumbles), 1, tmp_path).wrong
    monkeypatch.setattr(trying, "BASE_S", -1e9)
    assert "bytes" in tried(Kind("slow", report, lambda content, place: None), 1, tmp_path).wrong
