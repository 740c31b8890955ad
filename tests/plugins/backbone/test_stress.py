"""Random schemas and prompts: the small run of `stress.py`, of which 10,000 were run by hand."""

from __future__ import annotations

import pytest

from tests.plugins.backbone.stress import stress

COUNT = 192


@pytest.mark.slow
def test_random_schemas_give_valid_json_or_a_named_field_and_never_stall() -> None:
    ends, broken = stress(COUNT)
    assert broken == []
    assert ends["valid"] > COUNT / 3
    assert ends["did not fit"] > 0
    assert sum(ends.values()) == COUNT
