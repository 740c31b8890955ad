"""Rows of a stage: the same seed gives the same row, and the stage "drawings" shows what others rarely show."""

from random import Random

import pytest

from research.generator.report import Report, make_report
from research.rows import row_stream
from research.rows.row_stream import stage_at

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


def test_a_run_goes_through_the_stages_one_after_the_other() -> None:
    assert [stage_at("auto", at)[0] for at in (0.0, 0.14, 0.16, 0.29, 0.31, 1.0)] == [
        "pictures", "pictures", "text", "text", "all", "all",
    ]  # fmt: skip
    assert stage_at("auto", 0.3)[1] == pytest.approx(0.0, abs=1e-6)
    assert stage_at("auto", 1.0)[1] == pytest.approx(1.0)
    assert stage_at("text", 0.4) == ("text", 0.4)
