"""Heads that say whether the evidence tells a value: labels, depleted reports, the fit, the command."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors import safe_open

from research.generator.report import depleted, make_report
from research.model import evidence_heads
from research.model.evidence_heads import fit, right_and_ordered
from research.model.tokens import Coder, load_tokenizer
from research.rows.report_rows import evidence
from research.training import train_evidence_heads
from research.training.train_evidence_heads import head_of, is_told, labelled, reports
from sgcad_core.settings import ROOT

WEIGHTS = ROOT / "plugins" / "backbone" / "mini" / "weights"


@given(st.integers(0, 400), st.integers(0, 10))
@settings(max_examples=40, deadline=None)
def test_a_depleted_report_lacks_sentences_and_what_only_they_tell(seed: int, again: int) -> None:
    whole = make_report(seed, modes={"text": 1.0})
    less = depleted(whole, Random(again))
    assert len(less.narrative) <= len(whole.narrative)
    assert less.stated | less.doubtful <= whole.stated | whole.doubtful
    assert (less.road, less.behavior) == (whole.road, whole.behavior)
    start = 0
    for end, facts in less.sentences:
        piece = less.narrative[start:end]
        assert piece in whole.narrative
        assert facts in [told for _, told in whole.sentences]
        start = end
    assert start == len(less.narrative) or not less.sentences or less.sentences == whole.sentences


def test_values_are_labelled_by_what_text_or_drawing_tells() -> None:
    coder = Coder(load_tokenizer(WEIGHTS))
    report = next(r for r in reports(9) if not r.has_image and "areas.0" in r.stated)
    row = evidence(coder, report.narrative, None)
    found = labelled(coder, report, row)
    assert {"legs.lanes_in", "actors.maneuver", "contacts.striker_area"} <= {value.head for value in found}
    assert all(value.told for value in found if value.head == "contacts.striker_area")
    assert all(row.picks[i] == (value.at, 1.0) for i, value in enumerate(found))
    nothing = depleted(report, AllGone())
    assert nothing.narrative == ""
    assert not any(value.told for value in labelled(coder, nothing, evidence(coder, "", None)))


class AllGone(Random):
    """Leaves every sentence out."""

    def random(self) -> float:
        self.asked = getattr(self, "asked", 0) + 1
        return 1.0 if self.asked == 1 else 0.0


def test_what_is_no_fact_or_told_in_part_has_no_label() -> None:
    report = next(r for r in reports(400, held_out=True) if r.doubtful & {f"lanes.{axis}" for axis in range(4)})
    doubtful = next(fact for fact in report.doubtful if fact.startswith("lanes."))
    leg = next(i for i, leg in enumerate(report.crash.legs) if leg.bearing % 4 == int(doubtful[-1]))
    assert is_told(report, ("legs", leg, "lanes_in")) is None
    assert is_told(report, ("legs", leg, "kind")) is None
    assert head_of(("legs", leg, "turns_in", 0)) == "legs.turns_in"


def test_a_head_finds_the_direction_that_tells() -> None:
    torch.manual_seed(0)
    seen = torch.randn(400, 6) * 3 + 1
    told = seen[:, 2] > 1
    weights = fit(seen, told)
    right, ordered = right_and_ordered(weights, seen, told)
    assert right > 0.97
    assert ordered > 0.99
    assert weights[:-1].abs().argmax() == 2
    assert right_and_ordered(torch.zeros(7), seen, told)[1] == pytest.approx(0.5)


@pytest.mark.slow
def test_the_command_writes_heads_for_the_weights_beside_them(tmp_path: Path, monkeypatch, capsys) -> None:
    folder = tmp_path / "weights"
    shutil.copytree(WEIGHTS, folder)
    (folder / evidence_heads.FILE).unlink(missing_ok=True)
    monkeypatch.setattr("sys.argv", ["train_told", str(folder), "--count", "40", "--check", "10"])
    train_evidence_heads.main()
    with safe_open(folder / evidence_heads.FILE, "pt") as opened:
        assert len(opened.metadata()["model"]) == 64
        assert "legs.lanes_in" in opened.keys()  # noqa: SIM118 - is no mapping
    assert "pairs=" in capsys.readouterr().out
