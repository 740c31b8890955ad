"""What is worked out once a case: anew at a first attempt, remembered afterwards, never a failure."""

import pytest

from sgcad_core.asking.case_cache import KEPT, CaseCache
from sgcad_core.case.records import Context, Diagram
from sgcad_core.errors import InvalidOutput


def test_a_first_attempt_makes_anew_and_further_ones_remember() -> None:
    once, made = CaseCache[int](), iter(range(10))
    context = Context(narrative="V1 struck V2.")
    assert [once.of(context, n, lambda: next(made)) for n in (1, 2, 3, 1, 2)] == [0, 0, 0, 1, 1]


def test_other_evidence_is_another_case() -> None:
    once = CaseCache[str]()
    text = "V1 struck V2."
    plain, drawn = (
        Context(narrative=text),
        Context(narrative=text, diagrams=(Diagram(png=b"x", width_px=1, height_px=1),)),
    )
    assert once.of(plain, 1, lambda: "text") == "text"
    assert once.of(drawn, 2, lambda: "picture") == "picture"
    assert once.of(plain, 2, lambda: "never") == "text"


def test_a_failure_is_not_remembered() -> None:
    once, context = CaseCache[str](), Context(narrative="V1.")

    def fail() -> str:
        raise InvalidOutput("no JSON")

    with pytest.raises(InvalidOutput, match="no JSON"):
        once.of(context, 1, fail)
    assert once.of(context, 2, lambda: "mended") == "mended"


def test_it_does_not_grow_without_end() -> None:
    once = CaseCache[int]()
    for i in range(KEPT + 5):
        once.of(Context(narrative=str(i)), 1, lambda i=i: i)  # type: ignore[misc]
    assert once.of(Context(narrative="0"), 2, lambda: -1) == -1
    assert once.of(Context(narrative=str(KEPT)), 2, lambda: -1) == KEPT
