"""Robustness levels: the same report with less, or contradicting, evidence. Deterministic.

    full                as read
    semantic_noise      every number leaves the text, in digits and words, with its unit
    blur_weak|medium|strong   Gaussian blur of the diagrams (sigma 1, 3 and 6 px at 512 px width)
    modal_conflict      compass words and sides of the text are exchanged; the diagram stays
    critical_depletion  sentences with directions, sides or the contact leave the text
    total_sparsity      "A collision occurred." and no diagram

The report's notes name what was done. Knows no folder and no format.
"""

from __future__ import annotations

import io
import re
from typing import Literal, get_args

from PIL import ImageFilter

from sgcad_core.case.records import CrashReport, Diagram
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText, joined, placed, runs
from sgcad_core.system.pictures import opened

Level = Literal[
    "full", "semantic_noise", "blur_weak", "blur_medium", "blur_strong", "modal_conflict", "critical_depletion",
    "total_sparsity",
]  # fmt: skip
LEVELS: tuple[Level, ...] = get_args(Level)
SIGMA_PX = {"blur_weak": 1.0, "blur_medium": 3.0, "blur_strong": 6.0}
REFERENCE_WIDTH_PX = 512
SPARSE = "A collision occurred."

_DIGITS, _SPELLED = rule("degrade.digits"), rule("degrade.spelled")
_TURNED = {
    "north": "east", "east": "south", "south": "west", "west": "north", "left": "right", "right": "left",
    "front": "back", "back": "front", "rear": "front",
}  # fmt: skip
_DIRECTED, _CRITICAL = rule("degrade.directed"), rule("degrade.critical")
_SENTENCE_GAP, _LEFT_OVER, _SPACES = rule("degrade.sentence_gap"), rule("degrade.left_over"), rule("privacy.spaces")


def degrade(report: CrashReport, level: Level) -> CrashReport:
    """The report at a robustness level; `full` returns it as it is."""
    if level == "full":
        return report
    changed: dict[str, object] = {"notes": (*report.notes, f"degraded: {level}")}
    if level in SIGMA_PX:
        changed["diagrams"] = tuple(_blurred(d, SIGMA_PX[level]) for d in report.diagrams)
    elif level == "total_sparsity":
        changed |= {"narrative": SPARSE, "places": ((0, 0, 0),), "diagrams": (), "coded": None}
    else:
        text, note = _TEXT[level](placed(report.narrative, report.places))
        changed |= {"narrative": text.text, "places": runs(text), "coded": None}
        changed["notes"] = (*report.notes, f"degraded: {level} ({note})")
    return report.model_copy(update=changed)


def _without_numbers(text: TracedText) -> tuple[TracedText, str]:
    """Removes numbers except those of actors (V1, Vehicle #2, vehicle one), which identify them."""
    digits = len(_DIGITS.findall(text.text))
    bare = text.sub(_DIGITS, "")
    words = len(_SPELLED.findall(bare.text))
    bare = bare.sub(_SPELLED, "").sub(_LEFT_OVER, "").sub(_SPACES, " ")
    return bare.strip(), f"{digits + words} numbers removed"


def _turned_round(text: TracedText) -> tuple[TracedText, str]:
    def swap(match: re.Match[str]) -> str:
        word = match.group(0)
        other = _TURNED[word.lower()]
        return other.capitalize() if word[0].isupper() else other

    count = len(_DIRECTED.findall(text.text))
    return text.sub(_DIRECTED, swap), f"{count} directions and sides turned: N>E>S>W>N, left<>right, front<>back"


def _without_critical(text: TracedText) -> tuple[TracedText, str]:
    sentences = text.split(_SENTENCE_GAP)
    kept = [s for s in sentences if not _CRITICAL.search(s.text)]
    left = joined(kept, " ")
    nothing = TracedText(SPARSE, [0] * len(SPARSE), [0] * len(SPARSE))
    return left if left.text else nothing, f"{len(sentences) - len(kept)} of {len(sentences)} sentences removed"


_TEXT = {
    "semantic_noise": _without_numbers, "modal_conflict": _turned_round, "critical_depletion": _without_critical,
}  # fmt: skip


def _blurred(picture: Diagram, sigma_px: float) -> Diagram:
    """The diagram blurred; sigma grows with its width, so that every diagram loses the same detail."""
    image = opened(picture.png)
    radius = sigma_px * picture.width_px / REFERENCE_WIDTH_PX
    out = io.BytesIO()
    image.filter(ImageFilter.GaussianBlur(radius)).save(out, "PNG")
    return Diagram(png=out.getvalue(), width_px=picture.width_px, height_px=picture.height_px)
