"""Closed questions under decoders: the same answer as spelling every option out, and tables that add up."""

from __future__ import annotations

import math
from typing import Any

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import priors
from benchmarks.options import Heard, Listener, decode
from plugins.backbone.hf_load import Loaded
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.plausible import Plausible
from tests.plugins.backbone import tiny
from tests.plugins.backbone.folders import TEMPLATE

WORDS = 6
OPTIONS = {"a": (0, 1, 5), "ab": (0, 2, 5), "c": (3, 5)}


@st.composite
def rows(draw: st.DrawFn) -> Heard:
    """Logits in front of every beginning of an option."""
    beginnings = sorted({s[:i] for s in OPTIONS.values() for i in range(len(s))})
    number = st.floats(-20, 20, allow_nan=False)
    return Heard(OPTIONS, {b: torch.tensor(draw(st.lists(number, min_size=WORDS, max_size=WORDS))) for b in beginnings})


def _by_hand(heard: Heard, prior: Heard, alpha: float) -> str:
    said: tuple[int, ...] = ()
    while said not in OPTIONS.values():
        allowed = sorted({s[len(said)] for s in OPTIONS.values() if s[: len(said)] == said})
        both = [(1 + alpha) * heard.after[said][t] - alpha * prior.after[said][t] for t in allowed]
        said = (*said, allowed[int(torch.stack(both).argmax())])
    return next(name for name, spelling in OPTIONS.items() if spelling == said)


@settings(max_examples=60, deadline=None)
@given(rows(), rows(), st.sampled_from([0.0, 0.5, 2.0]))
def test_contrast_over_options_is_the_formula_token_by_token(heard: Heard, prior: Heard, alpha: float) -> None:
    assert decode(Cad(alpha=alpha), heard, prior) == _by_hand(heard, prior, alpha)


@settings(max_examples=60, deadline=None)
@given(rows(), rows())
def test_implausible_options_all_of_them_fall_back_to_the_report(heard: Heard, prior: Heard) -> None:
    assert decode(Plausible(beta=0.9), heard, prior) == decode(Greedy(), heard, prior)


@settings(deadline=None)
@given(rows())
def test_log_p_is_that_of_all_tokens(heard: Heard) -> None:
    by_hand = sum(float(heard.after[OPTIONS["ab"][:i]].log_softmax(-1)[t]) for i, t in enumerate(OPTIONS["ab"]))
    assert math.isclose(heard.log_p("ab"), by_hand, abs_tol=1e-5)


@pytest.fixture(scope="module")
def listener() -> Listener:
    model, _ = tiny.build("text_only")
    return Listener(Loaded(model, tiny.tokenizer(), None, None))


def test_logits_are_those_of_the_whole_text(listener: Listener, monkeypatch: pytest.MonkeyPatch) -> None:
    listener.tokenizer.chat_template = TEMPLATE.replace("{% for c in m.content %}", "{% set c = m.content %}").replace(
        "{% if c.type == 'image' %}<vision_start><image><vision_end>{% else %}{{ c.text }}{% endif %}{% endfor %}",
        "{{ c }}",
    )
    questions = {"Was it hit?": ("yes", "no"), "Where?": ("front", "rear")}
    found = listener.hear("A car hit a van.", questions)
    for heard, (question, options) in zip(found, questions.items(), strict=True):
        begin = listener.tokenizer(listener._prompt("A car hit a van.", question), add_special_tokens=False)
        for option in options:
            spelling = heard.options[option]
            ids = torch.tensor([[*begin["input_ids"], *spelling[:-1]]])
            with torch.inference_mode():
                whole = listener.model(ids).logits[0, -len(spelling) :].float()
            for i in range(len(spelling)):
                assert torch.allclose(heard.after[spelling[:i]], whole[i], atol=1e-3)


def _truth(**changes: Any) -> dict[str, Any]:
    known = {"contact": True, "subject": {"manoeuvre": "stopped", "areas": ["back_left"]}, "other": None}
    return {**known, **changes}


def test_codes_become_right_options() -> None:
    right = {name: question.right(_truth()) for name, question in priors.QUESTIONS.items()}
    assert right == {
        "contact": {"yes"}, "subject": {"stopped"}, "other": frozenset(), "area": {"rear", "left side"},
    }  # fmt: skip
    assert priors.QUESTIONS["area"].right(_truth(contact=False)) == frozenset()


def test_tables_count_questions_and_split_by_prior() -> None:
    def row(report: str, against: bool, cad: bool) -> priors.Asked:
        right = dict.fromkeys(priors.ARMS, not against) | {"alpha 0.5": cad}
        return priors.Asked(report, "contact", "dev", against, right, (-1.0, -2.0))

    rows_ = [row("a", True, True), row("b", True, True), row("c", False, False), row("d", False, True)]
    found = priors.columns(rows_)
    assert found["against the prior"]["greedy"]["right"] == 0.0
    assert found["against the prior"]["alpha 0.5"]["right"] == 1.0
    assert found["with the prior"]["alpha 0.5"]["right"] == 0.5
    assert found["all"]["greedy"]["n"] == 4
    assert priors.sureness(rows_)["contact, wrong"] == {"n": 2, "with": -1.0, "without": -2.0}
    assert "against the prior" in priors.show({k: v for k, v in found.items() if v})
