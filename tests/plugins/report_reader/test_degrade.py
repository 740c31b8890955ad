"""Robustness levels take away what they name, nothing else, and say so."""

import io
import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from plugins.report_reader.auto import Auto
from plugins.report_reader.degrade import LEVELS, SPARSE, degrade
from sgcad_core.case.records import CrashReport, Diagram

TEXT = (
    "Vehicle one (V1), a 2001 Ford Escort, was traveling north in the second lane of a four-lane road at 48 kmph "
    "(30 mph). Vehicle #2 was stopped facing south. The front of V1 struck the left side of V2. It was daylight."
)


def picture(width=256) -> Diagram:
    noise = np.random.default_rng(0).integers(0, 255, (200, width, 3), dtype=np.uint8)
    out = io.BytesIO()
    Image.fromarray(noise).save(out, "PNG")
    return Diagram(png=out.getvalue(), width_px=width, height_px=200)


REPORT = CrashReport(case="c", narrative=TEXT, diagrams=(picture(),))


def test_full_is_the_report_itself():
    assert degrade(REPORT, "full") is REPORT


def test_semantic_noise_leaves_actors_and_no_other_number():
    text = degrade(REPORT, "semantic_noise").narrative
    assert "Vehicle one (V1)" in text
    assert "Vehicle #2" in text
    assert not any(word in text for word in ("2001", "second", "four", "48", "30", "mph", "kmph"))
    assert "The front of V1 struck the left side of V2." in text


def test_modal_conflict_turns_directions_and_sides_and_keeps_the_diagram():
    report = degrade(REPORT, "modal_conflict")
    assert "traveling east in" in report.narrative
    assert "facing west" in report.narrative
    assert "The back of V1 struck the right side of V2." in report.narrative
    assert report.diagrams == REPORT.diagrams
    assert "4 directions and sides turned" in report.notes[-1]


def test_depletion_keeps_what_is_not_critical():
    report = degrade(REPORT, "critical_depletion")
    assert report.narrative == "It was daylight."
    assert "3 of 4 sentences removed" in report.notes[-1]


def test_total_sparsity_leaves_one_sentence_and_no_picture():
    report = degrade(REPORT, "total_sparsity")
    assert (report.narrative, report.diagrams) == (SPARSE, ())


def test_blur_grows_with_its_level_and_leaves_the_text():
    sharp = [np.asarray(Image.open(io.BytesIO(degrade(REPORT, level).diagrams[0].png)), float).std()
             for level in ("full", "blur_weak", "blur_medium", "blur_strong")]  # fmt: skip
    assert sharp == sorted(sharp, reverse=True)
    assert sharp[-1] < sharp[0] / 4
    assert degrade(REPORT, "blur_strong").narrative == TEXT


@settings(max_examples=60, deadline=None)
@given(st.text(max_size=300), st.sampled_from(LEVELS))
def test_any_text_can_be_degraded_twice_alike(text, level):
    report = CrashReport(case="c", narrative=text)
    assert degrade(report, level) == degrade(report, level)


@pytest.mark.parametrize("level", LEVELS)
def test_a_config_chooses_the_level(tmp_path, level):
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "report.txt").write_text(TEXT)
    assert Auto(robustness_level=level).read(tmp_path / "c").narrative == degrade(REPORT, level).narrative


REAL = Path(os.environ.get("SGCAD_DATA", Path(__file__).resolve().parents[3].parent / "shared" / "data")) / "dev/cases"


@pytest.mark.data
@pytest.mark.skipif(not REAL.is_dir(), reason="real reports are not here (set SGCAD_DATA)")
@pytest.mark.parametrize("level", LEVELS)
def test_real_reports_lose_what_the_level_names(level):
    for case in sorted(REAL.iterdir()):
        text = Auto(robustness_level=level).read(case).narrative
        assert text
        if level == "semantic_noise":
            left = re.findall(r"(?<!\w)\d+", re.sub(r"(?i)\b(?:vehicles?|v)\s*#?\s*\d|#\s*\d", "", text))
            assert len(left) <= 3, (case.name, left)
