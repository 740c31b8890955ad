"""Diagrams in GGUF models: the tokens of the same weights and pictures in transformers, and what cannot be."""

from __future__ import annotations

import re
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import torch
import transformers as tf

from plugins.backbone.hf_vision import HfVision
from plugins.backbone.llama.pictures import HOLE, GgufPrompts, spans
from plugins.backbone.llama.projector import MARKER
from plugins.backbone.llama_cpp import LlamaCpp
from plugins.backbone.prompt import parts
from plugins.decoder.cad import Cad
from plugins.decoder.grd import Grd
from plugins.decoder.greedy import Greedy
from plugins.decoder.vcd import Vcd
from research.benchmarks.decoding import family_models
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import folders, gguf_file, tiny
from tests.plugins.backbone.llama import projector_file
from tests.plugins.backbone.test_llama_cpp import changed

pytestmark = pytest.mark.skipif(
    find_spec("llama_cpp") is None or find_spec("gguf") is None, reason="the extras llama and smol are not there"
)
LIMIT = 60
_QWEN3 = next(family for family in family_models.FAMILIES if family.name == "Qwen3-VL")
_GEMMA = next(family for family in family_models.FAMILIES if family.name == "Gemma 3")
_MORE = (*(f"<extra{i}>" for i in range(4)), "<|endoftext|>")
"""Tokens up to the models' vocabulary, so that both libraries name the same ones."""


def _with_text(family: family_models.FamilyModel, **fields: Any) -> dict[str, Any]:
    return {**family.fields, "text_config": {**family.fields["text_config"], **fields}}


@dataclass(frozen=True)
class Kind:
    """A family: its tiny model, its name in GGUF, a size of pictures that nobody changes, what its template shows."""

    family: family_models.FamilyModel
    named: str
    size: tuple[int, int]
    shown: str
    shown_in_file: str = "{{ c.text }}"


KINDS = {
    "qwen3_vl": Kind(
        replace(
            _QWEN3,
            fields=_with_text(_QWEN3, rope_parameters={
                "rope_type": "default", "rope_theta": 10000.0, "mrope_section": [3, 3, 2], "mrope_interleaved": True,
            }),
            specials=(*_QWEN3.specials, *_MORE),
        ),
        "qwen3vl", (40, 24), "<|vision_start|><image><|vision_end|>",
    ),
    "gemma3": Kind(
        replace(_GEMMA, fields=_with_text(_GEMMA, query_pre_attn_scalar=16), specials=(*_GEMMA.specials, *_MORE)),
        "gemma3", (16, 16), "<start_of_image>",
        "{{ c.text | replace('" + MARKER + "', '\n\n" + MARKER + "\n\n') }}",
    ),
}  # fmt: skip


def report(kind: str, seed: int, pictures: int = 1) -> Context:
    shown = tuple(folders.diagram(seed + i, *KINDS[kind].size) for i in range(pictures))
    return folders.context(seed, pictures=0).model_copy(update={"diagrams": shown})


class Both:
    """The same weights for both libraries, float32."""

    def __init__(self, kind: str, folder: Path) -> None:
        self.kind = kind
        family = replace(KINDS[kind].family, shown=KINDS[kind].shown)
        family_models.save(family, folder / "folder")
        model = tf.AutoModelForImageTextToText.from_pretrained(folder / "folder", dtype=torch.float32)
        if kind == "gemma3":  # transformers begins it with zeros, which show nothing
            torch.nn.init.normal_(model.model.multi_modal_projector.mm_input_projection_weight)
            model.save_pretrained(folder / "folder")
        words, named = family_models.tokenizer(family.specials), KINDS[kind].named
        template = family_models.template("").replace("{{ c.text }}", KINDS[kind].shown_in_file)
        file = gguf_file.write(folder / "made.gguf", model, words, named, template)
        assert family.pixels is not None
        self.projector = projector_file.write(folder / "mmproj-made.gguf", model, family.pixels.made())
        model.generation_config.eos_token_id = [2, tiny.VOCABULARY - 1]  # the file's <|endoftext|> ends answers too
        model.generation_config.save_pretrained(folder / "folder")
        known: dict[str, Any] = {"max_new_tokens": LIMIT}
        self.inside = HfVision.model_validate(
            {"model": str(folder / "folder"), "dtype": "float32", "device": "cpu", **known}
        )
        self.llama = LlamaCpp.model_validate(
            {"model": str(file), "projector": str(self.projector), "threads": 1, "window": 512, **known}
        )

    def prompts(self) -> GgufPrompts:
        found = self.llama._started().prompter
        assert isinstance(found, GgufPrompts)
        return found

    def forget(self) -> None:
        self.llama._started().engine.runner.forget()  # type: ignore[attr-defined]


@pytest.fixture(scope="module", params=list(KINDS))
def both(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Both:
    return Both(request.param, tmp_path_factory.mktemp(request.param))


def question(schema: bool = True, **fields: Any) -> Query:
    return Query(task="Tell.", answer_schema=tiny.SCHEMA if schema else None, **fields)


def spelled(answer: Generation) -> list[str]:
    return [token.text for token in answer.tokens]


@pytest.mark.parametrize("schema", [True, False])
@pytest.mark.parametrize("decoder", [Greedy(), Cad(alpha=0.7), Cad(alpha=0.7, beta=0.1), Grd(), Vcd()])
def test_tokens_are_those_of_transformers(decoder: Decoder, schema: bool, both: Both) -> None:
    for seed in range(2):
        told = report(both.kind, seed, pictures=1 + seed)
        found, wanted = (one.generate(told, question(schema), decoder) for one in (both.llama, both.inside))
        assert spelled(found) == spelled(wanted)
        ours, theirs = (torch.tensor([t.logp_with_context for t in one.tokens]) for one in (found, wanted))
        assert torch.allclose(ours, theirs, atol=0.1)
        assert found.grounding == pytest.approx(wanted.grounding, abs=0.4)
        assert not any("pictures" in note for note in found.notes)


def test_the_drawing_stands_in_the_row_with_evidence_only(both: Both) -> None:
    told, query = report(both.kind, 0, pictures=2), question()
    shown, without = (both.prompts().prompt(one) for one in (parts(told, query), parts(None, query)))
    first, second = spans(shown)
    assert [shown.ids[at] for one in (first, second) for at in (one.start, one.end - 1)] == [HOLE] * 4
    assert HOLE not in [*shown.ids[: first.start], *shown.ids[first.end : second.start], *shown.ids[second.end :]]
    assert first.picture.digest != second.picture.digest
    assert not without.pictures
    assert HOLE not in without.ids
    if both.kind == "qwen3_vl":
        assert (first.end - first.start, first.shown.positions) == (15, 5), "5 x 3 tokens at 5 positions"


def test_the_answer_hangs_on_the_drawing_and_its_place(both: Both) -> None:
    one, other = (
        report(both.kind, 0),
        report(both.kind, 0).model_copy(update={"diagrams": report(both.kind, 5).diagrams}),
    )
    logps = [
        [t.logp_with_context for t in both.llama.generate(told, question(), Greedy()).tokens] for told in (one, other)
    ]
    assert logps[0] != logps[1]
    behind = changed(both.llama, pictures_first=False, window=500)
    assert [t.logp_with_context for t in behind.generate(one, question(), Greedy()).tokens] != logps[0]


def test_a_repair_encodes_no_picture_again_and_gives_the_answer_of_a_model_that_kept_nothing(both: Both) -> None:
    told = report(both.kind, 3)
    both.llama.generate(told, question(), Cad())
    projector, query = both.prompts().projector, question(attempt=2, repair="The lanes are wrong. Tell again.")
    known = dict(projector.kept)
    kept = both.llama.generate(told, query, Cad())
    assert list(projector.kept) == list(known), "no further picture"
    both.forget()
    projector.kept.clear()
    assert spelled(kept) == spelled(both.llama.generate(told, query, Cad()))


def test_reports_with_and_without_drawings_side_by_side_get_the_answers_that_they_get_alone(both: Both) -> None:
    fields = {name: field for name, field in tiny.SCHEMA["properties"].items() if name != "name"}
    schema = {**tiny.SCHEMA, "properties": fields, "required": list(fields)}  # a free text hangs on the last digits
    query = Query(task="Tell.", answer_schema=schema)
    told = [report(both.kind, seed, pictures=seed % 3) for seed in range(4)]
    alone = [spelled(both.llama.generate(one, query, Cad())) for one in told]
    many = changed(both.llama, reports_at_once=3)
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda one: many.generate(one, query, Cad()), told))
    assert [spelled(one) for one in together] == alone


def test_a_full_memory_makes_room_for_a_picture(both: Both) -> None:
    tight = changed(both.llama, window=256)
    wanted = spelled(tight.generate(report(both.kind, 0, 2), question(), Cad()))
    for seed in range(1, 9):  # more prompts than the memory holds
        told = report(both.kind, seed, 2).model_copy(update={"narrative": f"{seed} " * 20})
        tight.generate(told, question(), Cad())
    assert spelled(tight.generate(report(both.kind, 0, 2), question(), Cad())) == wanted


def test_sequences_beyond_those_of_the_library_are_refused(both: Both) -> None:
    many = changed(both.llama, reports_at_once=64, window=256)
    if both.kind == "gemma3":
        with pytest.raises(ConfigError, match=r"264 sequences are needed.*lower backbone\.reports_at_once"):
            many.load()


# ------------------------------------------------------------------ what cannot be
def test_a_marker_in_a_report_is_text(both: Both) -> None:
    told = report(both.kind, 0).model_copy(update={"narrative": f"V1 {MARKER} struck V2."})
    shown = both.prompts().prompt(parts(told, question()))
    assert len(spans(shown)) == 1
    text = both.prompts().words.text(parts(told, question()), 1)
    assert text.count(MARKER) == 1
    assert "< __picture__>" in text


def test_a_template_that_drops_pictures_is_refused(both: Both, monkeypatch: pytest.MonkeyPatch) -> None:
    prompts = both.prompts()
    silent = replace(prompts.words.loaded, template="{% for m in messages %}{{ m.role }}{% endfor %}")
    monkeypatch.setattr(prompts.words, "loaded", silent)
    with pytest.raises(ConfigError, match=r"shows 0 of 1 pictures; use another file of the model, or report_reader"):
        prompts.prompt(parts(report(both.kind, 0), question()))


def test_files_that_are_no_projector_of_the_model_are_refused_before_and_at_loading(both: Both, tmp_path: Path) -> None:
    wide = tmp_path / "mmproj-wide.gguf"
    family = KINDS[both.kind].family
    fields = _with_text(family, hidden_size=96, head_dim=16)
    if both.kind == "qwen3_vl":
        fields["vision_config"] = {**fields["vision_config"], "out_hidden_size": 96}
    config = replace(family, fields=fields).config()
    assert family.pixels is not None
    projector_file.write(wide, tf.AutoModelForImageTextToText.from_config(config), family.pixels.made())
    cases = {
        str(wide): (
            r"none of its widths \[.*\] is that of the model's vectors, 64",
            r"mmproj-wide\.gguf: llama\.cpp does",
        ),
        both.llama.model: (
            r"is a model of kind '\w+', no projector \(kind 'clip'\)",
            r"made\.gguf: llama\.cpp does not open",
        ),
    }
    for file, (checked, loaded) in cases.items():
        wrong = changed(both.llama, projector=file, window=300)
        (line,) = wrong.offers(Cad())
        assert line.startswith(f"backbone.projector {file}: ")
        assert re.search(checked + r".*; name the mmproj file that was published with the model", line)
        with pytest.raises(ConfigError, match=f"{loaded}.*name the mmproj file that was published with the model"):
            wrong.load()


def test_the_check_names_a_projector_that_is_missing_or_not_named(both: Both) -> None:
    missing = changed(both.llama, projector="hub:nobody/none-GGUF/mmproj-none.gguf")
    assert missing.offers(Cad()) == (
        "backbone: backbone.projector hub:nobody/none-GGUF/mmproj-none.gguf is not on this machine: "
        "hf download nobody/none-GGUF mmproj-none.gguf",
    )
    unnamed = changed(both.llama, projector=None)
    assert unnamed.offers(Cad())[-1] == (
        "backbone: diagrams are left out: backbone.projector names no mmproj file of made.gguf; mmproj-made.gguf lies "
        "beside it"
    )
    assert "diagrams are shown by mmproj-made.gguf" in both.llama.offers(Cad())[-1]
    with_it, without = both.llama.weights_gb(), unnamed.weights_gb()
    assert with_it is not None
    assert without is not None
    assert with_it - without == pytest.approx(both.projector.stat().st_size / 1e9)
    assert both.llama.stamp != unnamed.stamp
    with pytest.raises(ValueError, match=r"names no \.gguf file"):
        LlamaCpp(model="made.gguf", projector="mmproj")


def test_a_library_without_pictures_is_named(both: Both, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "llama_cpp.mtmd_cpp", None)
    with pytest.raises(MissingTool, match=r"needs llama-cpp-python with its library for pictures \(mtmd\)"):
        changed(both.llama, window=310).load()
