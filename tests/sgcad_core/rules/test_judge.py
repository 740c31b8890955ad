"""Findings in order, counts for metrics, and nothing after the first contact."""

from __future__ import annotations

from sgcad_core.rules.judge import broken, figures, judge
from sgcad_core.rules.records import RULES
from tests.sgcad_core.rules.drives import scene


def test_what_happens_after_the_contact_is_no_driving() -> None:
    made = scene("road", V1={"way": "S -N", "at": [[-200, 18], [60, 18]], "aside": [[-60, 0], [-30, -9], [200, -9]]},
                 V2={"way": "S -N", "at": [[-100, 0.1], [-80, 0.1]]})  # fmt: skip
    assert made.movers[0].until is not None
    assert "off_road" not in {f.rule for f in broken(judge(made))}


def test_figures_count_actors_and_keep_unknown_apart() -> None:
    fast = {"way": "S -N", "at": [[-200, 25], [60, 25]]}
    told, untold = judge(scene("road", V1=fast)), judge(scene("untold", V1=fast))
    assert figures(told) == dict.fromkeys(RULES, 0) | {"speed_limit": 1, "broken": 1, "unknown": 0}
    assert figures(untold) == dict.fromkeys(RULES, 0) | {"broken": 0, "unknown": 1}
    assert figures(told, "V2")["broken"] == 0


def test_a_finding_says_who_when_where_and_how_much() -> None:
    words = broken(judge(scene("road", V1={"way": "S -N", "at": [[-200, 25], [60, 25]]})))[0].words()
    assert words.startswith("V1 exceeded the speed limit, 0.0 to ")
    assert "25.00 m/s (limit 20.12); limit posted" in words
