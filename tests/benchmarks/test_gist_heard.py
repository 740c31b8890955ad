"""Logits at the values of a gist's answer: those of the whole text, and the questions that codes answer."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from benchmarks import priors
from benchmarks.gist_heard import GistListener
from benchmarks.gist_spelling import FIELDS, GistSpelling
from benchmarks.incidents import Incident
from mini.told import OPTIONS
from plugins.backbone.hf_load import Loaded
from tests.plugins.backbone import tiny

TEXT = "The AV was stopped and was hit."
TRUTH: dict[str, Any] = {
    "contact": True, "subject": {"manoeuvre": "straight", "areas": ["back_left"]},
    "other": {"kind": "vehicle", "manoeuvre": None, "areas": []}, "road": {"intersection": None, "kind": "Street"},
}  # fmt: skip


@pytest.fixture(scope="module")
def listener() -> GistListener:
    model, _ = tiny.build("text_only")
    return GistListener(Loaded(model, tiny.tokenizer(), None, None), "Say it.")


def test_logits_are_those_of_the_whole_text(listener: GistListener) -> None:
    heard, went = listener.hear(TEXT)
    spelling, said = listener.spelling, []
    begun = listener.prompter.tokenizer(f"Say it.\n\n{TEXT}\n\nAnswer:\n")["input_ids"]
    for key in FIELDS:
        said += list(spelling.leads[key])
        for value, tokens in spelling.values[key].items():
            with torch.inference_mode():
                whole = listener.model(torch.tensor([[*begun, *said, *tokens]])).logits[0].float()
            for at, depth in enumerate(spelling.branches(key, value)):
                row = whole[len(begun) + len(said) + depth - 1]
                assert torch.allclose(heard[key].after[heard[key].options[value][:at]], row, atol=1e-3)
        said += list(spelling.values[key][went[key]])


def test_without_the_report_the_answer_goes_by_the_same_values(listener: GistListener) -> None:
    _, went = listener.hear(TEXT)
    prior, same = listener.hear("", went)
    assert same == went
    assert set(prior) == set(OPTIONS)


def test_codes_become_right_values_and_what_moves_alike_is_right_too(listener: GistListener) -> None:
    told = priors.of_gist(listener)(Incident("kit-1", TEXT, TRUTH, "dev"))
    assert told.right["subject"] == {'"straight"', '"slowing"', '"negotiating_curve"'}
    assert told.right["subject_area"] == {'"back"', '"left"'}
    assert told.right["touched"] == {"true"}
    assert told.right["other"] == told.right["junction"] == frozenset()
    rows = priors.asked(priors.of_gist(listener), [Incident("kit-1", TEXT, TRUTH, "dev")])
    assert {row.field for row in rows} == {"touched", "met", "subject", "subject_area"}


def test_a_tokenizer_that_joins_a_value_with_its_quotes_is_told() -> None:
    class Joining:
        def __call__(self, text: str, add_special_tokens: bool = True) -> dict[str, list[int]]:
            return {"input_ids": [len(text)]}

    with pytest.raises(ValueError, match=r"does not spell .* piece by piece; use another model"):
        GistSpelling(Joining())
