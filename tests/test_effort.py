"""Costly families of tests: a spread of their cases is quick, and none is lost."""

import pytest

from tests.effort import spread


def parts(cases):
    """The values of quick cases and of slow ones."""
    slow = [case.values for case in cases if hasattr(case, "marks") and pytest.mark.slow.mark in map(_mark, case.marks)]
    return [case for case in cases if not hasattr(case, "marks")], slow


def _mark(mark):
    return getattr(mark, "mark", mark)


def test_the_first_case_and_each_nth_after_it_are_quick_and_the_others_slow():
    assert parts(spread("abcdefg", 3)) == (["a", "d", "g"], [("b",), ("c",), ("e",), ("f",)])


def test_a_case_of_several_arguments_keeps_them():
    assert parts(spread([("a", 1), ("b", 2)], 2)) == ([("a", 1)], [("b", 2)])


def test_a_case_that_is_marked_already_is_refused():
    with pytest.raises(TypeError, match="marks of its own: give the bare values"):
        spread([1, pytest.param(2)], 2)
