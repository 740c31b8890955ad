"""Which config commands take that are given none."""

import pytest

from sgcad_core import settings
from sgcad_core.config import load


def test_the_default_is_rules_and_model_together_and_the_environment_names_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("SGCAD_CONFIG")
    assert settings.default_config() == "fused.yaml"
    assert load(settings.default_config()).second_opinion == "whole"
    monkeypatch.setenv("SGCAD_CONFIG", "rag.yaml")
    assert settings.default_config() == "rag.yaml"
