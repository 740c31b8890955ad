"""Tiny models of current vision-language families: transformers' own classes, random weights, no download.

Each family is a model type, the fields of a tiny configuration, and its image processor. A folder that `save` writes
holds what a user's folder holds. Knows nothing of decoding.
"""

from __future__ import annotations

import importlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
import transformers as tf
from tokenizers import AddedToken, Tokenizer, decoders, models, pre_tokenizers, trainers
from transformers.models.auto.configuration_auto import CONFIG_MAPPING

IMAGE_TOKEN = 290
SPECIALS = ("<image>", "<video>", "<image_begin>", "<image_end>", "<image_row>")
"""Tokens 290 to 294."""
VOCABULARY = 300
_TEXT = {
    "vocab_size": VOCABULARY, "hidden_size": 64, "intermediate_size": 96, "num_hidden_layers": 3,
    "num_attention_heads": 4, "num_key_value_heads": 2, "head_dim": 16, "max_position_embeddings": 2048,
    "pad_token_id": 0, "bos_token_id": 1, "eos_token_id": 2,
}  # fmt: skip
_MROPE = {"rope_type": "default", "rope_theta": 10000.0, "mrope_section": [2, 3, 3]}
_SLIDES = {
    "sliding_window": 16, "num_hidden_layers": 3,
    "layer_types": ["sliding_attention", "sliding_attention", "full_attention"],
}  # fmt: skip
_VISION = {"hidden_size": 32, "intermediate_size": 48, "num_attention_heads": 2, "image_size": 16, "patch_size": 4}
_SIGLIP = {**_VISION, "model_type": "siglip_vision_model", "num_hidden_layers": 2}
_CLIP = {**_VISION, "model_type": "clip_vision_model", "num_hidden_layers": 3}
_PIXTRAL = {**_VISION, "model_type": "pixtral", "num_hidden_layers": 2, "image_size": 32}
_QWEN_VISION = {
    "depth": 2, "hidden_size": 32, "intermediate_size": 48, "num_heads": 2, "out_hidden_size": 64, "patch_size": 4,
    "spatial_merge_size": 2, "temporal_patch_size": 2,
}  # fmt: skip
_QWEN3_VISION = {**_QWEN_VISION, "depth": 3, "num_position_embeddings": 64, "deepstack_visual_indexes": [0, 1]}
_QWEN_TOKENS = {
    "image_token_id": IMAGE_TOKEN, "video_token_id": 291, "vision_start_token_id": 292, "vision_end_token_id": 293,
}  # fmt: skip
_GLM_VISION = {**_QWEN_VISION, "image_size": 32}
_GLM_TOKENS = {
    "image_token_id": IMAGE_TOKEN, "video_token_id": 291, "image_start_token_id": 292, "image_end_token_id": 293,
}  # fmt: skip
_GLM_SIZES = {
    "patch_size": 4, "temporal_patch_size": 2, "merge_size": 2, "size": {"shortest_edge": 64, "longest_edge": 2048},
}  # fmt: skip
_HALF = {**_MROPE, "mrope_section": [1, 1, 2], "partial_rotary_factor": 0.5}
_INTERLEAVED = {**_MROPE, "mrope_interleaved": True}
_EXPERTS = {"num_experts": 4, "num_experts_per_tok": 2, "moe_intermediate_size": 32}
_GRID = {"image_grid_pinpoints": [[16, 32], [32, 16], [32, 32]]}
_ID, _INDEX = {"image_token_id": IMAGE_TOKEN}, {"image_token_index": IMAGE_TOKEN}


def _text(model_type: str, **more: Any) -> dict[str, Any]:
    return {"text_config": {"model_type": model_type, **_TEXT, **more}}


@dataclass(frozen=True)
class Pixels:
    """An image processor of transformers: the folder of its model, its class, its tiny sizes."""

    module: str
    name: str
    fields: Mapping[str, Any] = field(default_factory=dict)

    def made(self) -> Any:
        """The processor. Raises ImportError for one that needs torchvision where that is not there."""
        found = importlib.import_module(f"transformers.models.{self.module}")
        return getattr(found, self.name)(**self.fields)


def _pil(family: str, name: str, **fields: Any) -> Pixels:
    return Pixels(f"{family}.image_processing_pil_{family}", f"{name}ImageProcessorPil", fields)


def _square(family: str, name: str, **more: Any) -> Pixels:
    return _pil(family, name, **{"size": {"height": 16, "width": 16}, **more})


_QWEN_PIXELS = _pil(
    "qwen2_vl", "Qwen2VL", patch_size=4, temporal_patch_size=2, merge_size=2,
    size={"shortest_edge": 64, "longest_edge": 1024},
)  # fmt: skip
_TILES = _square("got_ocr2", "GotOcr2", crop_to_patches=True, max_patches=4)
_PIXTRAL_PIXELS = _pil("pixtral", "Pixtral", size={"longest_edge": 32}, patch_size={"height": 4, "width": 4})
_CLIP_SIZES = {"size": {"shortest_edge": 16}, "crop_size": {"height": 16, "width": 16}}


@dataclass(frozen=True)
class FamilyModel:
    """One family: its name, the model type of transformers, the fields of a tiny configuration, its image processor.

    `specials`: what its tokenizer calls the tokens from 290 on; `shown`: what its chat template writes for a picture. A
    family that is refused by its configuration needs no processor.
    """

    name: str
    model_type: str
    fields: Mapping[str, Any] = field(default_factory=dict)
    pixels: Pixels | None = None
    specials: Sequence[str] = SPECIALS
    shown: str = "<image_begin><image><image_end>"

    def config(self) -> Any:
        """The tiny configuration."""
        return CONFIG_MAPPING[self.model_type](**self.fields)


FAMILIES = (
    FamilyModel("Qwen2-VL", "qwen2_vl", {
        **_text("qwen2_vl_text", rope_parameters=_MROPE), **_QWEN_TOKENS,
        "vision_config": {
            "depth": 2, "embed_dim": 32, "hidden_size": 64, "mlp_ratio": 2, "num_heads": 2, "patch_size": 4,
            "spatial_merge_size": 2, "temporal_patch_size": 2,
        },
    }, _QWEN_PIXELS),
    FamilyModel("Qwen2.5-VL", "qwen2_5_vl", {
        **_text("qwen2_5_vl_text", rope_parameters=_MROPE), **_QWEN_TOKENS,
        "vision_config": {**_QWEN_VISION, "window_size": 64, "fullatt_block_indexes": [0, 1]},
    }, _QWEN_PIXELS),
    FamilyModel("Qwen3-VL", "qwen3_vl", {
        **_text("qwen3_vl_text", rope_parameters=_INTERLEAVED), **_QWEN_TOKENS, "vision_config": _QWEN3_VISION,
    }, _QWEN_PIXELS),
    FamilyModel("Qwen3-VL-MoE", "qwen3_vl_moe", {
        **_text("qwen3_vl_moe_text", rope_parameters=_INTERLEAVED, **_EXPERTS), **_QWEN_TOKENS,
        "vision_config": _QWEN3_VISION,
    }, _QWEN_PIXELS),
    FamilyModel("Qwen3.5", "qwen3_5", {
        **_text("qwen3_5_text", rope_parameters=_INTERLEAVED, num_hidden_layers=4), **_QWEN_TOKENS,
    }),
    FamilyModel("InternVL3, InternVL3.5", "internvl", {
        **_text("qwen3"), **_ID, "image_seq_length": 4,
        "vision_config": {**_VISION, "num_hidden_layers": 2, "image_size": [16, 16], "patch_size": [4, 4]},
    }, _TILES, ("<image>", "<video>", "<img>", "</img>", "<image_row>"), "<image>\n"),
    FamilyModel("Gemma 3", "gemma3", {
        **_text("gemma3_text", **_SLIDES), **_INDEX, "vision_config": _SIGLIP, "mm_tokens_per_image": 4,
        "boi_token_index": 292, "eoi_token_index": 293,
    }, _square("gemma3", "Gemma3"), ("<image>", "<video>", "<start_of_image>", "<end_of_image>", "<image_row>"),
        "<start_of_image>"),
    FamilyModel("Gemma 3n", "gemma3n"),
    FamilyModel("Gemma 4", "gemma4", {"text_config": {
        "model_type": "gemma4_text", **_TEXT, **_SLIDES, "num_kv_shared_layers": 1,
    }}),
    FamilyModel("Mistral 3 (Small 3.1, 3.2)", "mistral3", {
        **_text("mistral"), **_INDEX, "vision_config": _PIXTRAL, "spatial_merge_size": 2,
    }, _pil("pixtral", "Pixtral", size={"longest_edge": 32}, patch_size={"height": 8, "width": 8}),
        ("[IMG]", "<video>", "[IMG_BREAK]", "[IMG_END]", "<image_row>"), "[IMG]"),
    FamilyModel("Pixtral", "llava", {
        **_text("mistral"), **_INDEX, "vision_config": _PIXTRAL, "vision_feature_select_strategy": "full",
        "vision_feature_layer": -1,
    }, _PIXTRAL_PIXELS, ("[IMG]", "<video>", "[IMG_BREAK]", "[IMG_END]", "<image_row>"), "[IMG]"),
    FamilyModel("Llama 3.2 Vision", "mllama", {
        "text_config": {
            **_TEXT, "num_hidden_layers": 4, "cross_attention_layers": [1, 3],
            "rope_parameters": {"rope_type": "default", "rope_theta": 10000.0},
        },
        "vision_config": {
            "hidden_size": 32, "attention_heads": 2, "num_hidden_layers": 2, "num_global_layers": 1,
            "intermediate_size": 48, "image_size": 16, "patch_size": 4, "max_num_tiles": 2, "vision_output_dim": 64,
            "intermediate_layers_indices": [1], "supported_aspect_ratios": [[1, 1], [1, 2], [2, 1]],
        }, **_INDEX,
    }, _square("mllama", "Mllama", max_image_tiles=2)),
    FamilyModel("Llama 4", "llama4"),
    FamilyModel("Idefics3", "idefics3", {
        **_text("llama"), **_ID, "scale_factor": 2, "vision_config": {**_VISION, "num_hidden_layers": 2},
    }, _pil("idefics3", "Idefics3", size={"longest_edge": 48}, max_image_size={"longest_edge": 16}), shown="<image>"),
    FamilyModel("SmolVLM", "smolvlm", {
        **_text("llama"), **_ID, "scale_factor": 2, "vision_config": {**_VISION, "num_hidden_layers": 2},
    }, _pil("smolvlm", "SmolVLM", size={"longest_edge": 48}, max_image_size={"longest_edge": 16}), shown="<image>"),
    FamilyModel("LLaVA 1.5", "llava", {**_text("llama"), **_INDEX, "vision_config": _CLIP},
        _pil("clip", "CLIP", **_CLIP_SIZES), shown="<image>\n"),
    FamilyModel("LLaVA-NeXT", "llava_next", {**_text("llama"), **_INDEX, **_GRID, "vision_config": _CLIP},
        _pil("llava_next", "LlavaNext", **_CLIP_SIZES, **_GRID), shown="<image>\n"),
    FamilyModel("LLaVA-OneVision", "llava_onevision", {
        **_text("qwen2"), **_INDEX, **_GRID, "vision_config": _SIGLIP, "vision_aspect_ratio": "anyres_max_9",
    }, _square("llava_onevision", "LlavaOnevision", **_GRID), shown="<image>\n"),
    FamilyModel("PaliGemma", "paligemma", {
        **_text("gemma"), **_INDEX, "vision_config": {**_SIGLIP, "projection_dim": 64}, "projection_dim": 64,
    }),
    FamilyModel("Aya Vision", "aya_vision", {
        **_text("cohere2", **_SLIDES), **_INDEX, "vision_config": _SIGLIP, "downsample_factor": 2,
    }, _TILES, ("<|IMG_PATCH|>", "<image>", "<|START_OF_IMG|>", "<|END_OF_IMG|>", "<image_row>"), "<image>"),
    FamilyModel("Command A Vision", "cohere2_vision", {
        **_text("cohere2", **_SLIDES), **_ID, "vision_config": _SIGLIP,
    }, Pixels("cohere2_vision.image_processing_cohere2_vision", "Cohere2VisionImageProcessor")),
    FamilyModel("GLM-4.1V", "glm4v", {
        **_text("glm4v_text", rope_parameters=_MROPE), **_GLM_TOKENS, "vision_config": _GLM_VISION,
    }, _pil("glm4v", "Glm4v", **_GLM_SIZES)),
    FamilyModel("GLM-4.6V", "glm46v", {
        **_text("glm4v_text", rope_parameters=_HALF), **_GLM_TOKENS,
        "vision_config": {"model_type": "glm4v_vision", **_GLM_VISION},
    }, _pil("glm46v", "Glm46V", **_GLM_SIZES)),
    FamilyModel("GLM-4.5V", "glm4v_moe", {
        **_text("glm4v_moe_text", rope_parameters=_HALF, n_routed_experts=4, num_experts_per_tok=2,
                moe_intermediate_size=32, n_group=1, topk_group=1), **_GLM_TOKENS, "vision_config": _GLM_VISION,
    }, _pil("glm4v", "Glm4v", **_GLM_SIZES)),
    FamilyModel("ViP-LLaVA", "vipllava", {
        **_text("llama"), **_INDEX, "vision_config": _CLIP, "vision_feature_layers": [-2, -1],
    }, _pil("clip", "CLIP", **_CLIP_SIZES), shown="<image>\n"),
    FamilyModel("Idefics2", "idefics2", {
        **_text("mistral"), **_ID, "vision_config": {**_VISION, "num_hidden_layers": 2},
        "perceiver_config": {
            "resampler_n_latents": 4, "resampler_depth": 1, "resampler_n_heads": 2, "resampler_head_dim": 16,
            "num_key_value_heads": 2, "hidden_size": 64,
        },
    }, _pil("idefics2", "Idefics2", size={"shortest_edge": 8, "longest_edge": 16}, do_image_splitting=False),
        shown="<image>"),
    FamilyModel("DeepSeek-VL", "deepseek_vl", {**_text("llama"), **_ID, "vision_config": _SIGLIP},
        _square("deepseek_vl", "DeepseekVL"), shown="<image>"),
    FamilyModel("Phi-4-multimodal", "phi4_multimodal"),
    FamilyModel("Kimi-VL (K2.5)", "kimi_k25", {},
        Pixels("kimi_k25.image_processing_kimi_k25", "Kimi_K25ImageProcessor")),
    FamilyModel("Molmo 2", "molmo2", {}, Pixels("molmo2.image_processing_molmo2", "Molmo2ImageProcessor")),
)  # fmt: skip
"""In the order of the table."""


def template(shown: str) -> str:
    """A chat template that writes pictures and texts in their order."""
    return (
        "<bos>{% for m in messages %}{{ m.role }}: {% for c in m.content %}{% if c.type == 'image' %}" + shown
        + "{% else %}{{ c.text }}{% endif %}{% endfor %}{% endfor %}"
        "{% if add_generation_prompt %}\nanswer: {% endif %}"
    )  # fmt: skip


def tokenizer(specials: Sequence[str]) -> Any:
    """A byte-level BPE of 300 tokens, trained on one made answer, with special tokens from 290 on."""
    made = Tokenizer(models.BPE())
    made.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    made.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=IMAGE_TOKEN, initial_alphabet=pre_tokenizers.ByteLevel.alphabet(), show_progress=False,
        special_tokens=["<pad>", "<bos>", "<eos>"],
    )  # fmt: skip
    made.train_from_iterator(['{"bearing":"NE","lanes_in":2,"turns_in":["left","right"]}'] * 4, trainer)
    fill = [f"<unused{i}>" for i in range(made.get_vocab_size(), IMAGE_TOKEN)]
    made.add_special_tokens([AddedToken(text, special=True, normalized=False) for text in (*fill, *specials)])
    return tf.PreTrainedTokenizerFast(
        tokenizer_object=made, pad_token="<pad>", bos_token="<bos>", eos_token="<eos>",  # noqa: S106 - no password
    )  # fmt: skip


def save(family: FamilyModel, folder: Path) -> Path:
    """Writes a tiny model as a folder; without weights where the family is refused before they are read."""
    spelled = tokenizer(family.specials)
    spelled.chat_template = template(family.shown)
    spelled.save_pretrained(folder)
    config = family.config()
    config.save_pretrained(folder)
    if family.pixels is None:
        return folder
    if not family.pixels.name.endswith("Pil"):  # it cannot be made without torchvision: a loader needs its name only
        kind = json.dumps({"image_processor_type": family.pixels.name})
        (folder / "preprocessor_config.json").write_text(kind, encoding="utf-8")
        return folder
    family.pixels.made().save_pretrained(folder)
    model = _random(config)
    model.generation_config.eos_token_id = 2
    model.save_pretrained(folder)
    return folder


def _random(config: Any) -> Any:
    """The model with weights large enough that pictures and text matter."""
    torch.manual_seed(0)
    model = tf.AutoModelForImageTextToText.from_config(config).eval()
    with torch.no_grad():
        for name, weight in model.named_parameters():
            if weight.ndim > 1 and "embed" not in name:
                weight.mul_(6.0)
            if "gate" in name and weight.ndim == 1:
                weight.fill_(0.5)
        model.get_output_embeddings().weight[IMAGE_TOKEN:] = 0.0  # no answer contains a picture's token
    return model
