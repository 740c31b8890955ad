"""Rules, learned reader and model against codes: what codes judge, the combiner's fit, and the table."""

from __future__ import annotations

import random

from research.benchmarks.texts.coded_claims import Judge
from research.benchmarks.texts.coded_fusion import LEAST, Case, Differing, fitted, p_of, table
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.combiner import AGAINST_TOLD, FIGURES, FILLS, needed, terms
from sgcad_core.records.second_reader import Weights
from tests.research.training.readers.test_train_numbered_reader import TEXT, line


def test_codes_judge_what_they_state_and_nothing_else() -> None:
    judge = Judge(line(), read(TEXT))
    assert judge.right("maneuver.V2", "parked") is True
    assert judge.right("maneuver.V1", "turn_left") is False
    assert judge.right("contact", ("V2", "V1")) is True
    assert judge.right("areas", (("V1", "front"), ("V2", "left"))) is False
    assert judge.right("legs", ("E", "W")) is True
    assert judge.right("lanes.E", (("E", 2, 2), ("W", 2, 2))) is True
    assert judge.right("lanes.E", (("E", 1, 1), ("W", 1, 1))) is False
    assert judge.right("lanes.N", (("N", 1, 1),)) is None
    assert judge.right("speed.V1", 30) is None


def differing(count: int, kind: str = "maneuver") -> list[Differing]:
    """Fields of which the model is right where it is sure and the rules only assume."""
    draw, found = random.Random(0), []
    for n in range(count):
        told, p = float(draw.random() < 0.5), draw.random()
        right = p > 0.5 and not told
        found.append(Differing(f"c{n}", kind, terms(p, told), told, not right, right))
    return found


def test_the_fit_lets_a_sure_model_win_against_what_nobody_told() -> None:
    before = {"maneuver": Weights(differ=-5.0), "areas": Weights(differ=-1.0)}
    after, lines = fitted([*differing(400), *differing(LEAST - 1, "areas")], before)
    assert after["areas"] == before["areas"], "too few to fit"
    assert [one.partition(",")[0] for one in lines] == ["maneuver"]
    assert after["maneuver"].told < 0 < after["maneuver"].slope
    some = [Differing("x", "maneuver", terms(0.95, t), t, False, True) for t in (0.0, 1.0)]
    sure, told = (p_of(after["maneuver"], one) for one in some)
    assert sure > FILLS > told


def test_no_figure_has_a_sign_that_makes_no_sense() -> None:
    wrong = [Differing(o.id, o.kind, o.terms, o.told, o.model_right, o.rules_right) for o in differing(200)]
    after, _ = fitted(wrong, {"maneuver": Weights()})
    assert all(getattr(after["maneuver"], name) >= 0 for name in FIGURES[1:] if name != "told")
    assert after["maneuver"].told <= 0


def test_against_what_a_text_tells_a_model_needs_a_margin() -> None:
    assert needed(0.6, 1.0) == AGAINST_TOLD > needed(0.6, 0.0) == 0.6
    assert needed(0.6, None) == FILLS


def test_the_table_has_no_text_of_a_line() -> None:
    lines = list(table([Case(line())], None))
    assert any(one.startswith("maneuver") and "rules 1.0000" in one for one in lines)
    assert not any("traveling" in one for one in lines)
