"""Rows of a stage: the same seed gives the same row, and the stage "drawings" shows what others rarely show."""

from random import Random

import pytest

from research.generator.report import Report, make_report
from research.rows import row_stream

SEEDS = range(31_000_000, 31_000_120)


def reports(stage: str) -> list[Report]:
    return [row_stream._report(Random(seed), seed, 0.0, stage) for seed in SEEDS]


def test_the_stage_of_drawings_shows_mostly_drawings_of_rare_things() -> None:
    shown = {stage: [r for r in reports(stage) if r.has_image] for stage in ("drawings", "all")}
    with_image = (row_stream.DRAWN["image"] + row_stream.DRAWN["both"]) / sum(row_stream.DRAWN.values())
    others = 1 - row_stream.WRITTEN["drawings"]
    assert len(shown["drawings"]) / len(SEEDS) == pytest.approx(with_image * others, abs=0.12)
    share = {stage: sum(map(row_stream.shows_rare, some)) / len(some) for stage, some in shown.items()}
    assert share["drawings"] > 0.6
    assert share["drawings"] > 1.5 * share["all"]


def test_a_seed_gives_the_same_report_again() -> None:
    once, again = ([(r.seed, r.mode, r.narrative) for r in reports("drawings")] for _ in range(2))
    assert once == again


def test_rare_is_what_the_drawing_itself_shows() -> None:
    drawn = [r for seed in SEEDS if (r := make_report(seed, modes={"image": 1.0})).has_image]
    for report in drawn:
        kinds = {a.kind for a in report.crash.actors if a.vehicle} & {"truck", "bus", "motorcycle", "bicycle"}
        arrows = any(leg.turns_in for leg in report.crash.legs) and any(f.startswith("turns.") for f in report.drawn)
        center = any(leg.twltl for leg in report.crash.legs)
        assert row_stream.shows_rare(report) == bool(kinds or arrows or center)
