"""hf_vision from a folder to a Generation: every architecture, every decoder, every bad input."""

from __future__ import annotations

import gc
import importlib.util
import json
import math
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import torch
from safetensors.torch import save_file

from plugins.backbone import hf_load
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.nucleus import Nucleus
from plugins.decoder.plausible import Plausible
from plugins.decoder.vcd import Vcd
from sgcad_core.case.records import Context, Generation, Passage, Query
from sgcad_core.errors import BadInput, ConfigError, InvalidOutput, MissingTool
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import folders, tiny

DECODERS: list[Decoder] = [
    Greedy(), Nucleus(), Cad(), Cad(alpha=0.0), Cad(beta=0.2), AdaCad(), Plausible(), Vcd(), Cad(temperature=0.8)
]  # fmt: skip
QUERY = Query(task="Describe the road.", answer_schema=tiny.SCHEMA)


@pytest.fixture(scope="module")
def backbones(tmp_path_factory: pytest.TempPathFactory) -> dict[str, HfVision]:
    made = {}
    for name in (*tiny.BUILDERS, "text_only"):
        folder = folders.save(name, tmp_path_factory.mktemp(name))
        made[name] = HfVision(model=str(folder), device="cpu", dtype="float32", max_new_tokens=200)
    return made


def test_a_small_model_on_the_processor_computes_with_one_thread(tmp_path: Path) -> None:
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        hf_load.load(str(folders.save("text_only", tmp_path)), None, {"dtype": "float32"}, "cpu", "none")
        assert torch.get_num_threads() == 1
    finally:
        torch.set_num_threads(before)


def valid(generation: Generation) -> Any:
    answer = json.loads(generation.text)
    assert list(answer) == list(tiny.SCHEMA["properties"])
    assert answer["bearing"] in tiny.SCHEMA["properties"]["bearing"]["enum"]
    assert 0 <= answer["lanes_in"] <= 12
    assert len(answer["turns_in"]) <= 3
    return answer


@pytest.mark.parametrize("name", [*tiny.BUILDERS, "text_only"])
@pytest.mark.parametrize("decoder", DECODERS, ids=lambda d: f"{type(d).__name__}-{getattr(d, 'alpha', '')}")
def test_every_architecture_runs_every_decoder(backbones: dict[str, HfVision], name: str, decoder: Decoder) -> None:
    generation = backbones[name].generate(folders.context(), QUERY, decoder, seed=3)
    answer = valid(generation)
    assert generation.finish == "stop"
    assert "".join(t.text for t in generation.tokens) == generation.text
    assert any(t.forced for t in generation.tokens)
    assert all(math.isfinite(t.logp_with_context) for t in generation.tokens)
    if decoder.reads_prior():
        leaves = {"bearing", "lanes_in", "name", "speed", "turns_in[]"} | {
            f"turns_in[{i}]" for i in range(len(answer["turns_in"]))
        }
        assert set(generation.grounding) == leaves
    else:
        assert generation.grounding == {}
        assert all(t.logp_without_context is None for t in generation.tokens)


def test_grounding_is_the_sum_over_the_fields_tokens(backbones: dict[str, HfVision]) -> None:
    generation = backbones["qwen2_5_vl"].generate(folders.context(), QUERY, Cad())
    start = generation.text.index('"name":') + len('"name":')
    end = generation.text.index(',"speed"')
    total, at = 0.0, 0
    for token in generation.tokens:
        begin, at = at, at + len(token.text)
        if begin < end and at > start and not (begin < start and at <= start):
            assert token.logp_without_context is not None
            total += token.logp_with_context - token.logp_without_context
        if at >= end:
            break
    assert generation.grounding["name"] == pytest.approx(total, abs=1e-6)


def heads(folder: Path, size: int = 65, **metadata: str) -> None:
    """Heads that are sure of names and unsure of bearings."""
    sure = torch.zeros(size)
    sure[-1] = 3.0
    save_file({"name": sure, "bearing": torch.zeros(size)}, folder / "told.safetensors", metadata)


def test_heads_beside_the_weights_say_what_the_evidence_tells(tmp_path: Path) -> None:
    folder = folders.save("qwen2_5_vl", tmp_path / "m")
    without = HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=200).generate(
        folders.context(), QUERY, Greedy()
    )
    heads(folder)
    found = HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=200).generate(
        folders.context(), QUERY, Greedy()
    )
    assert without.told == {}
    assert found.text == without.text, "heads change no answer"
    assert found.told["name"] == pytest.approx(1 / (1 + math.exp(-3)))
    assert set(found.told.items()) <= {("name", found.told["name"]), ("bearing", 0.5)}


@pytest.mark.parametrize(
    ("write", "fault"),
    [
        (lambda folder: heads(folder, size=9), "a head of this model has 65 numbers"),
        (lambda folder: heads(folder, model="0" * 64), "fitted on other weights"),
        (lambda folder: (folder / "told.safetensors").write_text("x"), "no file of safetensors"),
    ],
    ids=["size", "weights", "text"],
)
def test_heads_of_another_model_are_refused(tmp_path: Path, write: Callable[[Path], None], fault: str) -> None:
    folder = folders.save("text_only", tmp_path / "m")
    write(folder)
    with pytest.raises(ConfigError, match=f"told.safetensors.*{fault}.*take the file away"):
        HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=200).generate(
            folders.context(), QUERY, Greedy()
        )


def test_the_evidence_changes_the_answer_and_its_grounding(backbones: dict[str, HfVision]) -> None:
    backbone = backbones["qwen2_5_vl"]
    grounds = [backbone.generate(folders.context(seed), QUERY, Cad()).grounding for seed in range(3)]
    assert grounds[0] != grounds[1] != grounds[2]
    nothing = backbone.generate(Context(narrative=""), QUERY, Cad())
    assert all(abs(nats) < 1e-3 for nats in nothing.grounding.values())


def test_the_same_seed_gives_the_same_answer_and_another_seed_another(backbones: dict[str, HfVision]) -> None:
    backbone = backbones["llava"]
    texts = [backbone.generate(folders.context(), QUERY, Nucleus(temperature=2.0), seed).text for seed in (1, 1, 2)]
    assert texts[0] == texts[1] != texts[2]


def test_many_threads_get_the_answers_they_would_get_alone(backbones: dict[str, HfVision]) -> None:
    backbone = backbones["qwen3_vl"]
    alone = [backbone.generate(folders.context(i, i % 3), QUERY, Cad()).text for i in range(6)]
    with ThreadPoolExecutor(6) as pool:
        together = list(pool.map(lambda i: backbone.generate(folders.context(i, i % 3), QUERY, Cad()).text, range(6)))
    assert together == alone


def _apart(backbone: HfVision) -> HfVision:
    """The same model that shares neither loop nor kept prompts with the other."""
    return HfVision(**{**backbone.model_dump(), "prefix_cache_mb": 0})


def test_a_repair_reuses_the_prompt_and_the_answer_before(backbones: dict[str, HfVision]) -> None:
    backbone = backbones["qwen2_5_vl"]
    passages = (Passage(id="p1", kind="rule", text="Lanes are counted at the widest section. " * 5),)
    query = Query(task="Describe the road.", passages=passages, answer_schema=tiny.SCHEMA)
    first = backbone.generate(folders.context(9), query, Cad())
    fresh = _apart(backbone)
    repair = query.model_copy(update={"repair": f"Mend this: {first.text}", "attempt": 2})
    second = backbone.generate(folders.context(9), repair, Cad())
    unaided = fresh.generate(folders.context(9), repair, Cad())
    assert second.text == unaided.text
    assert second.model_calls < unaided.model_calls


def test_a_further_sample_takes_the_one_before_as_a_draft_and_stays_the_sample_it_would_be(
    backbones: dict[str, HfVision],
) -> None:
    backbone = backbones["qwen2_5_vl"]
    decoder = Cad(temperature=0.1)
    backbone.generate(folders.context(9), QUERY, decoder, seed=1)
    further = QUERY.model_copy(update={"attempt": 2})
    drafted = backbone.generate(folders.context(9), further, decoder, seed=2)
    unaided = _apart(backbone).generate(folders.context(9), further, decoder, seed=2)
    assert drafted.text == unaided.text
    assert drafted.model_calls < unaided.model_calls


def test_special_tokens_in_a_narrative_stay_text(backbones: dict[str, HfVision]) -> None:
    backbone = backbones["qwen2_5_vl"]
    nasty = Context(narrative="<eos>answer: {} <image><bos> V1 struck V2", diagrams=folders.context().diagrams)
    valid(backbone.generate(nasty, QUERY, Cad()))


def test_without_a_schema_the_answer_is_text_and_may_run_out(backbones: dict[str, HfVision]) -> None:
    generation = backbones["qwen2_5_vl"].generate(folders.context(), Query(task="Describe."), Greedy())
    assert generation.finish in ("length", "stop")
    assert len(generation.tokens) <= 200


def test_a_refusal_branch_of_the_schema_finishes_as_refused(backbones: dict[str, HfVision]) -> None:
    refusal = {
        "type": "object",
        "properties": {"refuse": {"enum": ["no layout"]}, "missing": {"type": "array", "maxItems": 0}},
        "required": ["refuse", "missing"], "additionalProperties": False,
    }  # fmt: skip
    query = Query(task="Describe.", answer_schema={"anyOf": [refusal, refusal]})
    generation = backbones["qwen2_5_vl"].generate(folders.context(), query, Cad())
    assert generation.finish == "refused"
    assert json.loads(generation.text) == {"refuse": "no layout", "missing": []}


# ------------------------------------------------------------------ bad input
def legs_of(item: dict[str, Any]) -> dict[str, Any]:
    legs = {"type": "array", "minItems": 1, "items": item}
    return {"type": "object", "properties": {"legs": legs}, "required": ["legs"]}


def test_a_field_that_does_not_fit_is_named(backbones: dict[str, HfVision]) -> None:
    tight = HfVision(**{**backbones["llava"].model_dump(), "max_new_tokens": 40})
    long = {"type": "string", "minLength": 200, "maxLength": 300}
    inner = {"type": "object", "properties": {"a": {"enum": [1]}, "text": long}, "required": ["a", "text"]}
    schema = legs_of(inner)
    with pytest.raises(InvalidOutput, match="not finished after 40 tokens") as caught:
        tight.generate(folders.context(), Query(task="", answer_schema=schema), Cad())
    assert caught.value.findings[0].where == "legs[0].text"


def test_a_schema_that_nothing_meets_is_invalid_output_with_its_path(backbones: dict[str, HfVision]) -> None:
    bad = {"type": "object", "properties": {"a": {"type": "integer", "minimum": 9, "maximum": 3}}, "required": ["a"]}
    schema = legs_of(bad)
    with pytest.raises(InvalidOutput, match=r"no answer can meet the schema at legs\[\]\.a"):
        backbones["llava"].generate(folders.context(), Query(task="", answer_schema=schema), Cad())


def test_a_prompt_beyond_the_window_names_both_numbers(backbones: dict[str, HfVision]) -> None:
    long = Context(narrative="V1 struck V2. " * 300)
    with pytest.raises(BadInput, match=r"prompt has \d{4} tokens .* window is 1024; set backbone.truncate"):
        backbones["qwen2_5_vl"].generate(long, QUERY, Cad())


def test_truncation_fits_the_window_and_is_noted(backbones: dict[str, HfVision]) -> None:
    cutting = HfVision(**{**backbones["qwen2_5_vl"].model_dump(), "truncate": True})
    generation = cutting.generate(Context(narrative="V1 struck V2. " * 300), QUERY, Cad())
    valid(generation)
    assert "the narrative was cut from 4199 to" in generation.notes[0]


def test_a_model_without_a_chat_template_gets_a_plain_prompt_and_a_note(tmp_path: Path) -> None:
    plain = HfVision(model=str(folders.save("qwen2_5_vl", tmp_path, None)), device="cpu", max_new_tokens=200)
    generation = plain.generate(folders.context(), QUERY, Cad())
    valid(generation)
    assert generation.notes == ("the model has no chat template: its prompt is plain text", "computed in float32")


def test_a_template_for_texts_only_still_shows_the_pictures(tmp_path: Path) -> None:
    for template in ("{{ messages[0]['content'] + 'x' }}", "{{ messages[0]['content'] | trim }}"):
        backbone = HfVision(model=str(folders.save("llava", tmp_path, template)), device="cpu", max_new_tokens=200)
        valid(backbone.generate(folders.context(), QUERY, Cad()))


def test_a_template_that_drops_pictures_is_refused(tmp_path: Path) -> None:
    folder = folders.save("llava", tmp_path, "{% for c in messages[0].content %}{{ c.text }}{% endfor %}")
    with pytest.raises(ConfigError, match="shows 0 of 1 pictures"):
        HfVision(model=str(folder), device="cpu").generate(folders.context(), QUERY, Cad())


def test_nan_logits_stop_the_report_with_the_step_and_not_the_others(tmp_path: Path) -> None:
    backbone = HfVision(model=str(folders.save("text_only", tmp_path)), device="cpu", max_new_tokens=60)
    properties = {k: v for k, v in tiny.SCHEMA["properties"].items() if k != "name"}
    query = Query(task="", answer_schema={**tiny.SCHEMA, "properties": properties, "required": list(properties)})
    good = backbone.generate(folders.context(1, 0), query, Cad())
    poison = backbone._loaded().prompter.tokenizer.convert_tokens_to_ids("Z")
    with torch.no_grad():
        backbone._loaded().engine.runner.model.get_input_embeddings().weight[poison] = float("nan")
    with ThreadPoolExecutor(4) as pool:
        futures = [
            pool.submit(backbone.generate, Context(narrative=text), query, Cad())
            for text in (folders.context(1, 0).narrative, "Z", folders.context(1, 0).narrative)
        ]
    with pytest.raises(InvalidOutput, match="NaN or inf behind token"):
        futures[1].result()
    for _ in range(3):
        assert backbone.generate(folders.context(1, 0), query, Cad()).text == good.text
    assert [futures[i].result().text for i in (0, 2)] == [good.text] * 2


def test_a_special_token_inside_the_answers_words_is_refused(backbones: dict[str, HfVision]) -> None:
    schema = {"type": "object", "properties": {"<image>": {"enum": [1]}}, "required": ["<image>"]}
    with pytest.raises(ConfigError, match=r"special tokens \['<image>'\] are text that the answer must contain"):
        backbones["llava"].generate(folders.context(), Query(task="", answer_schema=schema), Cad())


def test_added_tokens_that_run_over_fields_are_used_by_the_grammar(tmp_path: Path) -> None:
    folder = folders.save("text_only", tmp_path)
    from transformers import AutoTokenizer

    tokenizer = AutoTokenizer.from_pretrained(folder)
    tokenizer.add_tokens(['{"bearing":"', '","lanes_in":', ',"turns_in":['])
    tokenizer.save_pretrained(folder)
    from transformers import AutoModelForCausalLM

    model = AutoModelForCausalLM.from_pretrained(folder)
    model.resize_token_embeddings(len(tokenizer))
    model.save_pretrained(folder)
    generation = HfVision(model=str(folder), device="cpu", max_new_tokens=200).generate(folders.context(), QUERY, Cad())
    valid(generation)
    texts = [t.text for t in generation.tokens]
    assert texts[0] == '{"bearing":"'
    assert '","lanes_in":' in texts


def test_a_missing_model_says_where_it_looked(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"backbone\.model .*nowhere cannot be loaded: .*give a folder with config"):
        HfVision(model=str(tmp_path / "nowhere")).generate(folders.context(), QUERY, Cad())


def test_quantization_without_its_package_says_how_to_install_it(backbones: dict[str, HfVision]) -> None:
    if importlib.util.find_spec("bitsandbytes"):
        pytest.skip("bitsandbytes is installed here")
    packed = HfVision(**{**backbones["llava"].model_dump(), "quantization": "int4"})
    with pytest.raises(MissingTool, match=r"the package bitsandbytes is not installed: pip install 'sg-cadvlm\[gpu\]'"):
        packed.generate(folders.context(), QUERY, Cad())


def test_an_unknown_device_is_a_config_error(backbones: dict[str, HfVision]) -> None:
    with pytest.raises(ConfigError, match=r"backbone\.device 'gpu7' is unknown to torch"):
        HfVision(**{**backbones["llava"].model_dump(), "device": "gpu7"}).generate(folders.context(), QUERY, Cad())


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float32])
def test_native_is_the_dtype_that_the_device_multiplies_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, dtype: torch.dtype
) -> None:
    monkeypatch.setattr("plugins.precision.native_dtype", lambda device: dtype if device == "cpu" else None)
    folder = str(folders.save("qwen2_5_vl", tmp_path))
    backbone = HfVision(model=folder, device="cpu", dtype="native", max_new_tokens=200)
    found = backbone.generate(folders.context(), QUERY, Greedy())
    valid(found)
    assert backbone._loaded().engine.runner.model.dtype == dtype
    assert f"computed in {str(dtype).removeprefix('torch.')}" in found.notes


@pytest.mark.slow
def test_backbones_of_one_model_share_it_and_the_last_one_frees_it(tmp_path: Path) -> None:
    folder = str(folders.save("qwen2_5_vl", tmp_path))
    first, second = (HfVision(model=folder, device="cpu", dtype="float32", max_new_tokens=n) for n in (200, 150))
    other = HfVision(model=folder, device="cpu", dtype="bfloat16", max_new_tokens=200)
    for backbone in (first, second, other):
        valid(backbone.generate(folders.context(), QUERY, Greedy()))
    engine = first._loaded().engine
    assert engine is second._loaded().engine
    assert engine is not other._loaded().engine
    weights, thread = weakref.ref(engine.runner.model), engine.thread
    assert thread is not None
    del first, engine, backbone
    gc.collect()
    assert weights() is not None
    valid(second.generate(folders.context(), QUERY, Cad()))
    del second
    gc.collect()
    thread.join(timeout=20)
    assert not thread.is_alive()
    gc.collect()
    assert weights() is None


def test_a_loop_that_has_ended_is_not_handed_on(tmp_path: Path) -> None:
    folder = str(folders.save("qwen2_5_vl", tmp_path))
    first, second = (HfVision(model=folder, device="cpu", dtype="float32", max_new_tokens=200) for _ in range(2))
    first._loaded().engine.close()
    for backbone in (second, first):
        valid(backbone.generate(folders.context(), QUERY, Greedy()))
    assert first._loaded() is second._loaded()


def test_other_weights_in_the_same_folder_are_another_stamp_and_other_notes_are_not(tmp_path: Path) -> None:
    (tmp_path / "model.safetensors").write_bytes(b"one")
    stamps = [HfVision(model=str(tmp_path)).stamp]
    (tmp_path / "README.md").write_text("notes", encoding="utf-8")
    stamps.append(HfVision(model=str(tmp_path)).stamp)
    (tmp_path / "model.safetensors").write_bytes(b"two")
    stamps.append(HfVision(model=str(tmp_path)).stamp)
    assert stamps[0] == stamps[1] != stamps[2]
    assert HfVision(model="Qwen/Qwen2.5-VL-7B-Instruct").stamp == ""


def test_tokens_at_which_both_rows_disagree_are_kept_with_their_fields(backbones: dict[str, HfVision]) -> None:
    kept = []
    for seed in range(4):
        found = backbones["text_only"].generate(folders.context(), QUERY, Cad(alpha=2.0, temperature=2.0), seed=seed)
        leaves = {*found.grounding, "$"}
        assert all(c.evidence != c.prior and c.field in leaves for c in found.conflicts)
        assert len(found.conflicts) <= sum(not t.forced for t in found.tokens)
        kept += found.conflicts
    assert {c.winner for c in kept} <= {"evidence", "prior", "neither"}
    assert kept
    assert backbones["text_only"].generate(folders.context(), QUERY, Greedy()).conflicts == ()


# ------------------------------------------------------------------ a tokenizer that is larger than the model
def with_tokens(folder: Path, texts: list[str], special: bool) -> Path:
    """The folder with further tokens in its tokenizer, behind the model's outputs."""
    from tokenizers import AddedToken

    tokenizer = tiny.tokenizer()
    tokenizer.add_tokens([AddedToken(f"<fill{i}>", special=True) for i in range(tiny.VOCABULARY - len(tokenizer))])
    tokenizer.add_tokens([AddedToken(text, special=special, normalized=False) for text in texts])
    tokenizer.save_pretrained(folder)
    return folder


def test_words_without_an_output_are_told_with_both_numbers(tmp_path: Path) -> None:
    folder = with_tokens(folders.save("text_only", tmp_path), ["roundabout", "crosswalk"], special=False)
    with pytest.raises(
        ConfigError, match=r"tokenizer has 302 tokens, the model 300 outputs: 2 tokens cannot be written"
    ):
        HfVision(model=str(folder), dtype="float32", device="cpu").load()


def test_special_tokens_that_are_only_read_may_lie_behind_the_outputs(tmp_path: Path) -> None:
    folder = with_tokens(folders.save("text_only", tmp_path), ["<|picture|>"], special=True)
    with pytest.raises(ConfigError, match="301 tokens"):  # it has no embedding either
        HfVision(model=str(folder), dtype="float32", device="cpu").load()
    model, _ = tiny.build("mllama")  # eight embeddings more than outputs
    assert model.get_input_embeddings().weight.shape[0] > model.get_output_embeddings().weight.shape[0]
    folder = with_tokens(folders.save("mllama", tmp_path / "mllama", template=None), ["<|picture|>"], special=True)
    backbone = HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=200)
    found = backbone.generate(
        Context(narrative="V1 struck V2."), Query(task="Tell.", answer_schema=tiny.SCHEMA), Greedy()
    )
    assert list(json.loads(found.text)) == list(tiny.SCHEMA["properties"])
