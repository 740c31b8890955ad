"""Alternatives of patterns as they are written."""

from __future__ import annotations

import re

import pytest

from sgcad_core.reading.language.data import language
from tests.sgcad_core.reading.language.branches import alternatives, groups, only, without


def _fewer(pattern: str) -> list[str]:
    return [without(pattern, group, number) for group, number in alternatives(pattern)]


@pytest.mark.parametrize(("pattern", "fewer"), [
    ("a", []),
    ("a|b", ["b", "a"]),
    ("x(?:a|bc)y", ["x(?:bc)y", "x(?:a)y"]),
    (r"(?P<n>a|[|)b]|\|)", [r"(?P<n>[|)b]|\|)", r"(?P<n>a|\|)", "(?P<n>a|[|)b])"]),
    ("(?!a|b)", ["(?!b)", "(?!a)"]),
    ("[]|](?:a|b)", ["[]|](?:b)", "[]|](?:a)"]),
])  # fmt: skip
def test_each_alternative_is_taken_out_once(pattern: str, fewer: list[str]) -> None:
    assert _fewer(pattern) == fewer


def test_one_branch_alone() -> None:
    pattern = "x(?:a|bc)y"
    group = groups(pattern)[1]
    assert [only(pattern, group, n) for n in range(2)] == ["x(?:a)y", "x(?:bc)y"]


@pytest.mark.slow
def test_every_pattern_of_the_rules_still_compiles_without_any_of_its_alternatives() -> None:
    for record in language().rules.values():
        for pattern in record.alternatives:
            for fewer in _fewer(pattern):
                filled = language().filled(
                    fewer, record.file, record.id, {n: re.escape(w) for n, w in record.given.items()}
                )
                re._parser.parse(filled)  # type: ignore[attr-defined]  # parsing is enough, and fast
