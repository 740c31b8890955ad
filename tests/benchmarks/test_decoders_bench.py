"""Decoders on made reports: values counted by who tells them, arms compared on the same reports."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import decoders
from benchmarks.made import as_report
from mini.generator.report import make_report
from sgcad_core.config import load


def counts(right: list[int], asked: int = 4) -> np.ndarray:
    found = np.zeros((len(right), len(decoders.SOURCES), 2))
    found[:, 0, 0], found[:, 0, 1] = right, asked
    return found


def test_every_arm_is_a_decoder_of_the_embedded_models_config() -> None:
    for name, told in decoders.ARMS.items():
        decoder = load("mini.yaml", (told,)).decoder
        assert decoder is not None
        assert getattr(decoder, "temperature", 0.0) == (0.3 if "0.3" in name else 0.0)
        assert getattr(decoder.at(1), "temperature", 0.0) == getattr(decoder, "temperature", 0.0)


def test_a_worse_arm_has_a_lower_share_and_a_small_p() -> None:
    text = decoders.table({"all": counts([4] * 20), "half": counts([2] * 20), "same": counts([4] * 20)})
    assert "20 of 20 reports, those that every arm answers in full; values: 80 told by the text." in text
    rows = [line for line in text.splitlines() if line.startswith(("| half", "| same"))]
    assert "| half | 0.500" in rows[0]
    assert "p < 0.01" in rows[0]
    assert "p 1.00" in rows[1]


def test_a_report_of_which_one_arm_gave_half_counts_for_none() -> None:
    whole, half = counts([3, 3, 4]), counts([3, 3, 4])
    half[0, 0] = 2, 2
    text = decoders.table({"whole": whole, "half": half})
    assert "2 of 3 reports" in text
    assert [line.split("|")[2].split()[0] for line in text.splitlines()[4:]] == ["0.875", "0.875"]
    with pytest.raises(SystemExit, match="more reports"):
        decoders.table({"none": counts([0], 0)})


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 4), min_size=2, max_size=12), st.integers(0, 11))
def test_a_report_that_one_arm_refuses_counts_for_none(right: list[int], refused: int) -> None:
    one, other = counts(right), counts(right)
    other[refused % len(right)] = 0
    shares = [line.split("|")[2].split()[0] for line in decoders.table({"a": one, "b": other}).splitlines()[4:]]
    assert shares[0] == shares[1]


def test_the_embedded_model_is_asked_and_its_values_are_counted_by_source() -> None:
    reports = [make_report(seed, True, 0.6, {"text": 1.0}) for seed in range(61_000_000, 61_000_003)]
    pairs = [(report, as_report(report)) for report in reports]
    found = decoders.marks(load("mini.yaml", (decoders.ARMS["greedy"],)), pairs, 2)
    assert found.shape == (3, len(decoders.SOURCES), 2)
    assert (found[..., 0] <= found[..., 1]).all()
    told = decoders.SOURCES.index("text")
    assert found[:, told, 1].sum() > 20
    assert found[:, told, 0].sum() > 0.8 * found[:, told, 1].sum()
    assert found[:, decoders.SOURCES.index("diagram"), 1].sum() == 0
