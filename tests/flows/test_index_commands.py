"""`sgcad index`: built, asked and counted from the command line."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from flows.cli import app


def index(*arguments):
    return CliRunner().invoke(app, ["index", *map(str, arguments)])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("index") / "knowledge"
    built = index("build", "--out", place)
    assert built.exit_code == 0, built.output
    return place


def test_what_was_built_is_counted_by_kind_and_found_best_first(folder):
    told = index("stats", "--out", folder).output
    assert all(f" {kind}" in told for kind in ("api", "example", "snippet", "xml"))
    found = index("search", "a trajectory with times", "--task", "scenario", "-k", 3, "--out", folder).output
    assert [line[:3] for line in found.splitlines() if line[1:4] == ". ["] == ["1. ", "2. ", "3. "]
    assert "[snippet] snippet/timed_trajectory" in found.splitlines()[0]


def test_a_kind_that_the_index_does_not_have_is_told_with_its_remedy(folder):
    said = index("search", "two lanes each way", "--kind", "junction", "--out", folder).output
    assert said.startswith("nothing found: the index has no junction, only api, example, snippet, xml; ")
    assert said.rstrip().endswith("sgcad index add FILE")


def test_nothing_found_among_what_is_there_is_said_alone(folder):
    assert index("search", "zzzzqqqq", "--kind", "xml", "--out", folder).output == "nothing found\n"
