"""What a model could give away of the texts that it learned from."""

from random import Random

import pytest
import torch

from research.benchmarks.decoding.memorized import COPIED, LIMIT, drawn, embedded, longest_run, not_copied
from research.generator.incidents import make_incident
from research.model.tokens import Coder, load_tokenizer
from research.rows.collate import collate
from research.rows.gist_rows import gist_row
from research.training.train import answer_tokens
from sgcad_core import settings

WEIGHTS = settings.ROOT / "plugins" / "backbone" / "mini" / "weights"


def test_the_longest_run_is_found_wherever_it_lies() -> None:
    assert longest_run("xx the AV was stopped yy", "before the AV was stopped at") == " the AV was stopped "
    assert longest_run("nothing in common", "zzzz") == ""


def test_what_is_copied_from_the_beginning_was_no_secret() -> None:
    begun = "The AV was stopped at a red light."
    assert not_copied("It rained. The AV was stopped at noon", begun) == ["It rained. ", "noon"]
    assert not_copied("The AV was", begun) == ["The AV was"], f"shorter than {COPIED} characters: chance"
    assert not_copied("", begun) == []


def test_nothing_of_a_text_is_what_a_row_asks_for() -> None:
    coder = Coder(load_tokenizer(WEIGHTS))
    asked = set(answer_tokens(coder).tolist())
    for seed in range(60):
        told = make_incident(seed)
        batch = collate([gist_row(coder, told, Random(seed))], coder)
        assert set(batch.wanted.tolist()) <= asked, "a text's token was a target, so it could be learned by heart"


@pytest.mark.slow
def test_the_shipped_weights_continue_no_text() -> None:
    torch.set_num_threads(1)
    texts = [make_incident(seed).text for seed in range(4)]
    assert max(len(longest_run(one, "\n".join(texts))) for one in drawn(embedded(WEIGHTS), texts)) < LIMIT
