"""The traffic rules agree with drives that were labelled by hand."""

from __future__ import annotations

import pytest

from research.benchmarks.handover.rule_drives import labelled, main, verdicts
from sgcad_core.errors import BadInput
from sgcad_core.rules.records import RULES


def test_the_rules_agree_with_the_labels() -> None:
    found = list(verdicts(labelled()))
    assert len(found) >= 60
    assert [one.drive.name for one in found if not one.agrees] == []
    assert {one.drive.rule for one in found} == set(RULES)
    for rule in RULES:  # every rule is seen broken and not broken
        assert len({(any(r == rule for _, r in one.drive.label)) for one in found if one.drive.rule == rule}) == 2


def test_the_command_prints_the_agreement(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "agreement" in capsys.readouterr().out


def test_a_drive_that_cannot_be_built_is_named(tmp_path) -> None:
    file = tmp_path / "made.yaml"
    file.write_text("maps: {}\ndrives:\n- {name: lost, rule: red_light, map: none, why: nothing}\n")
    with pytest.raises(BadInput, match=r"made.yaml: drive 'lost'"):
        list(labelled(file))
