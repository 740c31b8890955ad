"""Tiny random models from transformers' real config classes, with pictures and prompts to match."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import torch
import transformers as tf

from plugins.backbone.engine.families import Family, family_of
from plugins.backbone.engine.records import Picture, Prompt

torch.set_num_threads(1)
VOCABULARY = 300
IMAGE_TOKEN = 290
_TEXT = {
    "vocab_size": VOCABULARY, "hidden_size": 64, "intermediate_size": 96, "num_hidden_layers": 3,
    "num_attention_heads": 4, "num_key_value_heads": 2, "max_position_embeddings": 1024, "pad_token_id": 0,
    "bos_token_id": 1, "eos_token_id": 2,
}  # fmt: skip


def _scale(model: Any, factor: float = 6.0) -> Any:
    """Random models say much the same everywhere; larger weights make the evidence and the text matter."""
    with torch.no_grad():
        for name, weight in model.named_parameters():
            if weight.ndim > 1 and "embed" not in name:
                weight.mul_(factor)
            if "gate" in name and weight.ndim == 1:
                weight.fill_(0.5)
    return model.eval()


def qwen2_5_vl() -> Any:
    rope = {"rope_type": "default", "rope_theta": 10000.0, "mrope_section": [2, 3, 3]}
    vision = {
        "depth": 2, "hidden_size": 32, "intermediate_size": 48, "num_heads": 2, "out_hidden_size": 64, "patch_size": 4,
        "spatial_merge_size": 2, "temporal_patch_size": 2, "window_size": 64, "fullatt_block_indexes": [0, 1],
    }  # fmt: skip
    config = tf.Qwen2_5_VLConfig(
        text_config={**_TEXT, "rope_parameters": rope}, vision_config=vision, image_token_id=IMAGE_TOKEN,
        video_token_id=291, vision_start_token_id=292, vision_end_token_id=293, tie_word_embeddings=True,
    )  # fmt: skip
    return tf.Qwen2_5_VLForConditionalGeneration(config)


def qwen3_vl() -> Any:
    rope = {"rope_type": "default", "rope_theta": 10000.0, "mrope_section": [2, 3, 3], "mrope_interleaved": True}
    vision = {
        "depth": 3, "hidden_size": 32, "intermediate_size": 48, "num_heads": 2, "out_hidden_size": 64, "patch_size": 4,
        "spatial_merge_size": 2, "temporal_patch_size": 2, "num_position_embeddings": 64,
        "deepstack_visual_indexes": [0, 1],
    }  # fmt: skip
    config = tf.Qwen3VLConfig(
        text_config={**_TEXT, "head_dim": 16, "rope_parameters": rope}, vision_config=vision,
        image_token_id=IMAGE_TOKEN, video_token_id=291, vision_start_token_id=292, vision_end_token_id=293,
    )  # fmt: skip
    return tf.Qwen3VLForConditionalGeneration(config)


def llava() -> Any:
    vision = {
        "model_type": "clip_vision_model", "hidden_size": 32, "intermediate_size": 48, "num_hidden_layers": 3,
        "num_attention_heads": 2, "image_size": 16, "patch_size": 4,
    }  # fmt: skip
    config = tf.LlavaConfig(
        text_config=tf.LlamaConfig(**_TEXT), vision_config=tf.CLIPVisionConfig(**vision), image_token_index=IMAGE_TOKEN
    )
    return tf.LlavaForConditionalGeneration(config)


def idefics3() -> Any:
    vision = {
        "hidden_size": 32, "intermediate_size": 48, "num_hidden_layers": 2, "num_attention_heads": 2, "image_size": 16,
        "patch_size": 4,
    }  # fmt: skip
    config = tf.Idefics3Config(
        text_config=tf.LlamaConfig(**_TEXT), vision_config=vision, image_token_id=IMAGE_TOKEN, scale_factor=2
    )
    return tf.Idefics3ForConditionalGeneration(config)


def mllama() -> Any:
    vision = {
        "hidden_size": 32, "attention_heads": 2, "num_hidden_layers": 2, "num_global_layers": 1,
        "intermediate_size": 48, "image_size": 16, "patch_size": 4, "max_num_tiles": 2, "vision_output_dim": 64,
        "intermediate_layers_indices": [1], "supported_aspect_ratios": [[1, 1], [1, 2], [2, 1]],
    }  # fmt: skip
    rope = {"rope_type": "default", "rope_theta": 10000.0}
    text = {**_TEXT, "num_hidden_layers": 4, "cross_attention_layers": [1, 3], "rope_parameters": rope}
    config = tf.MllamaConfig(text_config=text, vision_config=vision, image_token_index=IMAGE_TOKEN)
    return tf.MllamaForConditionalGeneration(config)


def text_only() -> Any:
    return tf.LlamaForCausalLM(tf.LlamaConfig(**_TEXT))


BUILDERS: dict[str, Callable[[], Any]] = {
    "qwen2_5_vl": qwen2_5_vl, "qwen3_vl": qwen3_vl, "mllama": mllama, "idefics3": idefics3, "llava": llava
}  # fmt: skip


def build(name: str) -> tuple[Any, Family]:
    """A tiny random model and its family; the same weights every time."""
    torch.manual_seed(0)
    model = _scale({**BUILDERS, "text_only": text_only}[name]())
    return model, family_of(model)


def picture(name: str, seed: int) -> Picture:
    """A random picture as the model's image processor would have prepared it."""
    generator = torch.Generator().manual_seed(seed)

    def noise(*shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=generator)

    inputs: dict[str, torch.Tensor]
    if name.startswith("qwen"):
        height, width = 4 + 2 * (seed % 2), 4 + 2 * (seed % 3)
        grid = torch.tensor([[1, height, width]])
        inputs = {"pixel_values": noise(height * width, 3 * 2 * 4 * 4), "image_grid_thw": grid}
    elif name == "llava":
        inputs = {"pixel_values": noise(1, 3, 16, 16)}
    elif name == "idefics3":
        tiles = 1 + seed % 3
        mask = torch.ones(1, tiles, 16, 16, dtype=torch.long)
        inputs = {"pixel_values": noise(1, tiles, 3, 16, 16), "pixel_attention_mask": mask}
    else:
        ratio = 1 + seed % 2
        tiles_used = torch.tensor([[[1, 1 if ratio > 1 else 0]]])
        inputs = {
            "pixel_values": noise(1, 1, 2, 3, 16, 16),
            "aspect_ratio_ids": torch.tensor([[ratio]]),
            "aspect_ratio_mask": tiles_used,
        }
    return Picture(hashlib.sha256(f"{name}{seed}".encode()).hexdigest(), inputs)


def words(count: int, seed: int) -> list[int]:
    """Random ordinary token ids."""
    return torch.randint(3, 280, (count,), generator=torch.Generator().manual_seed(seed)).tolist()


def prompts(name: str, family: Family, seed: int, shared: int = 6) -> tuple[Prompt, Prompt]:
    """A report's two prompts: task | evidence with a picture | the rest, and the same without the evidence."""
    task, rest = words(shared, 7), words(3, 1000 + seed)
    evidence: list[int] = words(4 + 3 * (seed % 4), seed)
    pictures = []
    if name != "text_only" and seed % 4 != 3:
        pictures = [picture(name, seed)]
        evidence += [IMAGE_TOKEN] * family.tokens_of(pictures[0]) + words(2, seed + 50)
    return Prompt([*task, *evidence, *rest], pictures), Prompt([*task, *rest])


def tokenizer() -> Any:
    """A byte-level BPE of 300 tokens, trained on a few keys of the specs; specials where the models expect them."""
    from tokenizers import AddedToken, Tokenizer, decoders, models, pre_tokenizers, trainers

    made = Tokenizer(models.BPE())
    made.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    made.decoder = decoders.ByteLevel()
    corpus = ['{"legs":[{"bearing":"NE","lanes_in":2,"turns_in":["left","right"]}],"missing":[]}'] * 4
    trainer = trainers.BpeTrainer(
        vocab_size=290,
        initial_alphabet=pre_tokenizers.ByteLevel.alphabet(),
        show_progress=False,
        special_tokens=["<pad>", "<bos>", "<eos>"],
    )
    made.train_from_iterator(corpus, trainer)
    fill = [f"<unused{i}>" for i in range(made.get_vocab_size(), IMAGE_TOKEN)]
    specials = [*fill, "<image>", "<video>", "<vision_start>", "<vision_end>"]
    made.add_special_tokens([AddedToken(text, special=True, normalized=False) for text in specials])
    names = {"pad_token": "<pad>", "bos_token": "<bos>", "eos_token": "<eos>"}
    return tf.PreTrainedTokenizerFast(tokenizer_object=made, **names)


SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "bearing": {"type": "string", "enum": ["N", "NE", "E", "SE", "S"]},
        "lanes_in": {"type": "integer", "minimum": 0, "maximum": 12},
        "turns_in": {"type": "array", "items": {"enum": ["left", "right", "through"]}, "maxItems": 3},
        "name": {"type": "string", "maxLength": 6},
        "speed": {"anyOf": [{"type": "integer", "minimum": 5, "maximum": 85}, {"type": "null"}]},
    },
    "required": ["bearing", "lanes_in", "turns_in", "name", "speed"],
    "additionalProperties": False,
}
