"""Models, prompts, tokenizer and answer of the decoding benchmark: random weights, real shapes.

Needs torch, transformers and numpy; llguidance and tokenizers only for the grammar rows.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
import transformers as tf

from plugins.backbone.engine.families import Family, family_of
from plugins.backbone.engine.records import Picture, Prompt

IMAGE_TOKEN = 7
FIRST_TEXT = 300
"""Ids from here on are ordinary words of every vocabulary used here."""


@dataclass(frozen=True)
class Size:
    """One model: text dimensions, vocabulary, precision, and tokens of a report's parts."""

    name: str
    text: dict[str, Any]
    vision: dict[str, Any]
    dtype: torch.dtype
    passages: int = 160
    narrative: int = 200
    grid: tuple[int, int] = (16, 16)
    """Patches of the diagram; a quarter of them are tokens."""


def _text(hidden: int, layers: int, heads: int, kv: int, inner: int, vocabulary: int) -> dict[str, Any]:
    half = hidden // heads // 2
    first = half // 4
    rope = {
        "rope_type": "default",
        "rope_theta": 1e6,
        "mrope_section": [first, (half - first) // 2, -(-(half - first) // 2)],
    }
    return {
        "hidden_size": hidden, "num_hidden_layers": layers, "num_attention_heads": heads, "num_key_value_heads": kv,
        "intermediate_size": inner, "vocab_size": vocabulary, "max_position_embeddings": 32768, "rope_parameters": rope,
        "bos_token_id": 1, "eos_token_id": 2, "pad_token_id": 0,
    }  # fmt: skip


def _vision(hidden: int, depth: int, heads: int, out: int) -> dict[str, Any]:
    return {
        "hidden_size": hidden, "depth": depth, "num_heads": heads, "intermediate_size": hidden * 8 // 3,
        "out_hidden_size": out,
        "patch_size": 14, "spatial_merge_size": 2, "temporal_patch_size": 2, "window_size": 112,
        "fullatt_block_indexes": list(range(depth)),
    }  # fmt: skip


SIZES = {
    "tiny": Size(
        "tiny fp32, for the benchmark's own test", _text(64, 2, 4, 2, 128, 8192), _vision(32, 1, 2, 64), torch.float32,
        passages=40, narrative=30, grid=(4, 4),
    ),
    "15m": Size("15M fp32", _text(384, 6, 6, 2, 1024, 8192), _vision(128, 2, 4, 384), torch.float32),
    "200m": Size(
        "200M bf16, vocabulary 151,936", _text(768, 12, 12, 4, 2560, 151_936), _vision(256, 4, 4, 768), torch.bfloat16
    ),
    "7b": Size(
        "Qwen2.5-VL-7B, bf16", {**_text(3584, 28, 28, 4, 18944, 152_064), "rope_parameters": {
            "rope_type": "default", "rope_theta": 1e6, "mrope_section": [16, 24, 24]}},
        {**_vision(1280, 32, 16, 3584), "intermediate_size": 3420, "fullatt_block_indexes": [7, 15, 23, 31]},
        torch.bfloat16, passages=800, narrative=500, grid=(46, 62),
    ),
}  # fmt: skip


def build(size: Size, device: torch.device) -> tuple[Any, Family]:
    """A Qwen2.5-VL of that size with random weights, made on the device."""
    small = size.text["vocab_size"] < 100_000 or size.text["hidden_size"] < 2000
    config = tf.Qwen2_5_VLConfig(
        text_config=size.text, vision_config=size.vision, image_token_id=IMAGE_TOKEN, video_token_id=8,
        vision_start_token_id=9, vision_end_token_id=10, tie_word_embeddings=small,
    )  # fmt: skip
    torch.manual_seed(0)
    before = torch.get_default_dtype()
    torch.set_default_dtype(size.dtype)
    try:
        with device:
            model = tf.Qwen2_5_VLForConditionalGeneration(config)
    finally:
        torch.set_default_dtype(before)
    model = model.to(device, size.dtype).eval()
    return model, family_of(model)


def text_twin(model: Any) -> Any:
    """The same text layers as a plain text model, weights shared: transformers' guidance breaks on Qwen-VL."""
    text = model.config.text_config
    names = (
        "hidden_size", "num_hidden_layers", "num_attention_heads", "num_key_value_heads", "intermediate_size",
        "vocab_size", "max_position_embeddings", "rms_norm_eps", "bos_token_id", "eos_token_id", "pad_token_id",
    )  # fmt: skip
    rope = {"rope_type": "default", "rope_theta": 1e6}
    with torch.device("meta"):
        twin = tf.Qwen2ForCausalLM(tf.Qwen2Config(**{n: getattr(text, n) for n in names}, rope_parameters=rope))
    state = {f"model.{k}": v for k, v in model.model.language_model.state_dict().items()}
    state["lm_head.weight"] = model.lm_head.weight
    twin.load_state_dict(state, assign=True)
    twin.model.rotary_emb = type(twin.model.rotary_emb)(config=twin.config).to(model.device)
    return twin.eval()


def words(count: int, seed: int, top: int = 8000) -> list[int]:
    """Random ordinary tokens."""
    return np.random.default_rng(seed).integers(FIRST_TEXT, top, count).tolist()


def report(size: Size, seed: int, repair: int = 0, before: Sequence[int] = ()) -> tuple[Prompt, Prompt]:
    """Prompts with and without the evidence: passages | diagram, narrative | the answer before and its findings."""
    shared, end = words(size.passages, 1), words(4, 2)
    mend = [*end, *before, *words(repair, 900 + seed)] if repair else []
    rows, columns = size.grid
    count = rows * columns
    generator = torch.Generator().manual_seed(seed)
    inputs = {
        "pixel_values": torch.randn(count, 3 * 2 * 14 * 14, generator=generator),
        "image_grid_thw": torch.tensor([[1, rows, columns]]),
    }
    picture = Picture(hashlib.sha256(str(seed).encode()).hexdigest(), inputs)
    evidence = [IMAGE_TOKEN] * (count // 4) + words(size.narrative, 10 + seed)
    return Prompt([*shared, *evidence, *mend, *end], [picture]), Prompt([*shared, *mend, *end])


# ------------------------------------------------------------------ grammar
def _leg(bearing: str, lanes: int) -> dict[str, Any]:
    return {
        "bearing": bearing, "lanes_in": lanes, "lanes_out": lanes - 1,
        "turns_in": ["right", "through", "left"][: lanes - 1],
        "center_turn_lane": lanes == 3, "median": "painted" if lanes > 2 else "none", "kind": "road",
        "control": "signal" if lanes > 2 else "stop", "curve": "none", "speed_limit_mph": 35,
    }  # fmt: skip


ANSWER = {"legs": [_leg("N", 3), _leg("E", 2), _leg("S", 3), _leg("W", 2)], "accesses": []}
MENDED = {
    "legs": [{**_leg("N", 3), "median": "raised"}, _leg("E", 2), {**_leg("S", 3), "speed_limit_mph": 45}, _leg("W", 2)],
    "accesses": [],
}
"""The answer with two of its values changed."""


def _object(**properties: Any) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(properties), "additionalProperties": False}


def _one_of(*values: str) -> dict[str, Any]:
    return {"type": "string", "enum": list(values)}


_LANES = {"type": "integer", "minimum": 0, "maximum": 8}
_TURN = _one_of("left", "through", "right", "left_through", "through_right", "left_right", "any")
SCHEMA = _object(
    legs={
        "type": "array",
        "minItems": 2,
        "maxItems": 8,
        "items": _object(
            bearing=_one_of("N", "NE", "E", "SE", "S", "SW", "W", "NW"),
            lanes_in=_LANES,
            lanes_out=_LANES,
            turns_in={"type": "array", "items": _TURN, "maxItems": 8},
            center_turn_lane={"type": "boolean"},
            median=_one_of("none", "painted", "raised", "grass", "barrier"),
            kind=_one_of("road", "driveway", "ramp"),
            control=_one_of("none", "signal", "flashing", "stop", "yield"),
            curve=_one_of("none", "left", "right"),
            speed_limit_mph={"anyOf": [{"type": "integer", "minimum": 5, "maximum": 85}, {"type": "null"}]},
        ),
    },
    accesses={
        "type": "array",
        "maxItems": 4,
        "items": _object(leg=_one_of("N", "E", "S", "W"), side=_one_of("left", "right")),
    },
)
"""The shape of the project's road layout, written out so that the benchmark needs of the project its loop alone."""


@dataclass
class Language:
    """A tokenizer of the model's size and the benchmark's answers in it; None where llguidance is missing."""

    vocabulary: int
    maker: Any = None
    answer: list[int] = field(default_factory=list)
    mended: list[int] = field(default_factory=list)


def language(vocabulary: int) -> Language:
    """An ordinary byte-level BPE, filled up with unreached words to the vocabulary's size."""
    try:
        from plugins.backbone.engine.grammar import GrammarCompiler

        tokenizer = tokenizer_of(vocabulary)
        maker = GrammarCompiler(tokenizer, vocabulary, [2])
    except ImportError:
        return Language(vocabulary, None, words(160, 5), words(160, 5))
    spelled = [tokenizer(json.dumps(a, separators=(",", ":")))["input_ids"] for a in (ANSWER, MENDED)]
    return Language(vocabulary, maker, *spelled)


def tokenizer_of(vocabulary: int) -> Any:
    """An ordinary byte-level BPE, filled up with unreached words to the vocabulary's size."""
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers, trainers

    made = Tokenizer(models.BPE())
    split = pre_tokenizers.Split(
        __import__("tokenizers").Regex(r"'s|[^\r\n\p{L}\p{N}]?\p{L}+|\p{N}| ?[^\s\p{L}\p{N}]+[\r\n]*|\s+"),
        "isolated",
    )
    made.pre_tokenizer = pre_tokenizers.Sequence(
        [split, pre_tokenizers.ByteLevel(add_prefix_space=False, use_regex=False)]
    )
    made.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=min(vocabulary, 6000), initial_alphabet=pre_tokenizers.ByteLevel.alphabet(), show_progress=False,
        special_tokens=["<pad>", "<bos>", "<eos>", *(f"<special{i}>" for i in range(9))],
    )  # fmt: skip
    made.train_from_iterator(_corpus(), trainer)
    raw = json.loads(made.to_str())
    known = raw["model"]["vocab"]
    letters = np.array(list('abcdefghijklmnopqrstuvwxyzĠ_"{}[]:,0123456789'))
    random = np.random.default_rng(0)
    while len(known) < vocabulary:
        known.setdefault("".join(random.choice(letters, random.integers(2, 9))), len(known))
    filled = Tokenizer.from_str(json.dumps(raw))
    return tf.PreTrainedTokenizerFast(tokenizer_object=filled, **{"eos_token": "<eos>", "pad_token": "<pad>"})


def _corpus() -> list[str]:
    """Ordinary JSON and prose, none of it the answer itself: the vocabulary a general tokenizer would have."""
    prose = (
        "The left lane of the road through the signal had a painted median and a raised curb; the ramp to the "
        "right was none of the access roads. A leg bears north, its limit and kind of control are stop or yield, the "
        "grass barrier and center turn out of the driveway, the flashing speed limit sign in the curve of lanes mph "
    )
    made = [json.dumps({"name": word, "items": [1, 20, None, True, False], "kind": word}) for word in prose.split()]
    return [prose] * 20 + made * 4
