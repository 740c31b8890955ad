"""Diagrams in GGUF models: the tokens of the same weights and pictures in transformers, and what cannot be."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import torch
import transformers as tf

from plugins.backbone.hf_vision import HfVision
from plugins.backbone.llama import machine
from plugins.backbone.llama.pictures import HOLE, GgufPrompts, spans
from plugins.backbone.llama.projector import MARKER
from plugins.backbone.llama_cpp import LlamaCpp
from plugins.backbone.prompt import parts
from plugins.decoder.cad import Cad
from plugins.decoder.grd import Grd
from plugins.decoder.greedy import Greedy
from plugins.decoder.vcd import Vcd
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Decoder
from research.benchmarks.decoding import family_models
from tests.plugins.backbone import folders, gguf_file, tiny
from tests.plugins.backbone.llama import projector_file

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
