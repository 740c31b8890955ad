"""The attack sees what it looks for, goes on behind a death, and its kinds attack what they say."""

import random
from contextlib import suppress
from itertools import islice

import pytest

from research.benchmarks.attack import campaign
from research.benchmarks.attack.__main__ import main
from research.benchmarks.attack.campaign import Limits, fed, in_words, is_fault, row
from research.benchmarks.attack.feeder import size_of
from research.benchmarks.attack.kinds import kinds
from sgcad_core.errors import PluginFault, SgcadError
from tests.research.benchmarks.attack import evil_kind

EVIL = evil_kind.__name__
OWN = ("report text", "picture", "pdf", "plugin metadata", "desk requests", "default config")


@pytest.mark.slow
def test_every_kind_of_fault_is_seen_and_the_next_input_is_tried(tmp_path):
    found = list(fed(EVIL, len(evil_kind.WAYS), 1, Limits(15.0), tmp_path))
    by = dict(zip(evil_kind.WAYS[:-1], found, strict=False))
    assert [one.number for one in found] == list(range(len(found)))
    ends = {way: one.end for way, one in by.items()}
    assert (ends["refuse"], ends["stumble"], ends["plugin"], ends["say"]) == ("refused", *["traceback"] * 3)
    assert (ends["hang"], ends["die"], ends["exit"]) == ("hung", "died", "traceback")
    assert by["write"].wrote.endswith("elsewhere")
    assert by["made"].wrote.endswith("made")
    assert by["grow"].grown_mb > campaign.LARGE_MB
    assert by["slow"].slow
    assert [way for way, one in by.items() if not is_fault(one)] == ["well", "refuse"]
    assert not is_fault(found[-1])  # behind a hang and two deaths
    assert "KeyError: 'V5'" in in_words(by["stumble"])
    assert row("evil", found).startswith(f"| evil | {len(found)} | 6 | 1 | 4 | 1 | 1 | 1 | 1 | 2 |")
    assert list(tmp_path.glob("*/*")) == []


def test_a_seed_makes_the_same_inputs(tmp_path):
    for name in OWN:
        made = []
        for place in (tmp_path / f"{name}-1", tmp_path / f"{name}-2"):
            place.mkdir()
            items = islice(kinds()[name].inputs(random.Random("1"), place), 4)
            made.append([item if isinstance(item, str) else size_of(item) for item in items])
        assert made[0] == made[1]


@pytest.mark.parametrize("name", ["report text", "picture", "pdf", "plugin metadata"])
def test_the_first_inputs_end_as_they_should(name, tmp_path):
    for item in islice(kinds()[name].inputs(random.Random("2"), tmp_path), 25):
        with suppress(SgcadError):
            try:
                kinds()[name].feed(item)
            except PluginFault as fault:
                raise AssertionError(item) from fault


@pytest.mark.slow
def test_the_command_prints_a_table_and_adds_it_to_a_file(tmp_path, capsys):
    asked = ["--kinds", "desk requests,pdf", "--count", "6", "--out", str(tmp_path / "table.md")]
    assert main(asked) == 0
    shown = capsys.readouterr().out
    assert "| desk requests | 6 | 6 | 0 |" in shown
    assert shown == (tmp_path / "table.md").read_text()


@pytest.mark.parametrize("asked", [["--kinds", "nothing"], ["--count", "0"]])
def test_a_wrong_question_is_told(asked, capsys):
    with pytest.raises(SystemExit):
        main(asked)
    assert "there are: " in capsys.readouterr().err or asked[0] == "--count"
