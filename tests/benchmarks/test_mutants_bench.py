"""The tests of the language data are themselves tested."""

from __future__ import annotations

import pytest

from benchmarks.mutants import main, mutants, noticed
from sgcad_core.language.data import language


def test_nearly_every_deletion_is_noticed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--count", "300", "--seed", "7"]) == 0
    assert "of 300 noticed" in capsys.readouterr().out


OF_EACH = [("word", "cardinal"), ("alternative", "lanes.crossed"), ("rule", "deeds.merge")]


@pytest.mark.parametrize(("kind", "name"), OF_EACH)
def test_deletions_of_each_kind_are_noticed(kind: str, name: str) -> None:
    whole = language()
    found = [m for m in mutants(whole) if m.kind == kind and m.name == name]
    assert found
    assert all(noticed(m, whole) for m in found)


def test_the_whole_language_is_no_mutant() -> None:
    names = {m.name for m in mutants(language()) if m.kind == "rule"}
    assert names == set(language().rules)
