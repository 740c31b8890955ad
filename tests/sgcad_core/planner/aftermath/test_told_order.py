"""Which of the told contacts come about in their order."""

from __future__ import annotations

from sgcad_core.planner.aftermath.told_order import ToldOrder, met_in_order
from sgcad_core.planner.aftermath.wreck_bodies import Touch
from sgcad_core.planner.scene import Scene

AB, BC, AC = frozenset("AB"), frozenset("BC"), frozenset("AC")


def touches(*pairs: str) -> list[Touch]:
    return [Touch(4.0 + n, *pair) for n, pair in enumerate(pairs)]


def scene(*pairs: str) -> Scene:
    made = Scene(200, 80)
    made.touches = touches(*pairs)
    return made


def test_each_pair_is_looked_for_behind_the_one_before_it() -> None:
    found = met_in_order(touches("AB", "BC", "CA"), (AB, AC))
    assert [touch and touch.t_s for touch in found] == [4.0, 6.0]


def test_a_pair_that_touches_too_early_does_not_count() -> None:
    assert met_in_order(touches("BC", "AB"), (AB, BC))[1] is None


def test_a_pair_that_never_touches_does_not_hide_the_next_one() -> None:
    assert [bool(touch) for touch in met_in_order(touches("AB", "BC"), (AB, AC, BC))] == [True, False, True]


def test_the_order_holds_with_a_further_pair_or_not() -> None:
    order = ToldOrder(scene("AB", "BC"), frozenset({AB, BC}), [AB])
    assert order.kept
    assert order.holds(BC)
    assert not order.holds(AC)


def test_the_next_contact_is_looked_for_behind_the_last_one() -> None:
    assert ToldOrder(scene("AB", "BC"), frozenset(), [AB, BC]).after == 100
    assert ToldOrder(scene(), frozenset(), [AB]).after == 80


def test_pairs_that_are_not_told_are_counted_once() -> None:
    assert ToldOrder(scene("AB", "AC", "AC"), frozenset({AB})).untold == 1
