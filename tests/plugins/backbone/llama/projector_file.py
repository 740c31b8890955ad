"""The vision tower of a tiny Qwen3-VL or Gemma 3 of transformers as a projector file, as llama.cpp's converter does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from tests.plugins.backbone import gguf_file

_SIGLIP = {
    r"model\.vision_tower\.embeddings\.patch_embedding": "v.patch_embd",
    r"model\.vision_tower\.embeddings\.position_embedding": "v.position_embd",
    r"model\.vision_tower\.encoder\.layers\.(\d+)\.self_attn\.out_proj": r"v.blk.\1.attn_out",
    r"model\.vision_tower\.encoder\.layers\.(\d+)\.self_attn\.([qkv])_proj": r"v.blk.\1.attn_\2",
    r"model\.vision_tower\.encoder\.layers\.(\d+)\.layer_norm(\d)": r"v.blk.\1.ln\2",
    r"model\.vision_tower\.encoder\.layers\.(\d+)\.mlp\.fc1": r"v.blk.\1.ffn_up",
    r"model\.vision_tower\.encoder\.layers\.(\d+)\.mlp\.fc2": r"v.blk.\1.ffn_down",
    r"model\.vision_tower\.post_layernorm": "v.post_ln",
    r"model\.multi_modal_projector\.mm_input_projection_weight": "mm.input_projection.weight",
    r"model\.multi_modal_projector\.mm_soft_emb_norm": "mm.soft_emb_norm",
}
_QWEN3 = {
    r"model\.visual\.pos_embed": "v.position_embd",
    r"model\.visual\.blocks\.(\d+)\.norm(\d)": r"v.blk.\1.ln\2",
    r"model\.visual\.blocks\.(\d+)\.attn\.qkv": r"v.blk.\1.attn_qkv",
    r"model\.visual\.blocks\.(\d+)\.attn\.proj": r"v.blk.\1.attn_out",
    r"model\.visual\.blocks\.(\d+)\.mlp\.linear_fc1": r"v.blk.\1.ffn_up",
    r"model\.visual\.blocks\.(\d+)\.mlp\.linear_fc2": r"v.blk.\1.ffn_down",
    r"model\.visual\.merger\.norm": "v.post_ln",
    r"model\.visual\.merger\.linear_fc1": "mm.0",
    r"model\.visual\.merger\.linear_fc2": "mm.2",
    r"model\.visual\.deepstack_merger_list\.(\d+)\.norm": r"v.deepstack.\1.norm",
    r"model\.visual\.deepstack_merger_list\.(\d+)\.linear_fc(\d)": r"v.deepstack.\1.fc\2",
}


def write(file: Path, model: Any, pixels: Any) -> Path:
    """Writes the tower of a model whose pictures `pixels` prepares (float32); needs the package gguf."""
    import gguf

    config, vision = model.config, model.config.vision_config
    made = gguf.GGUFWriter(str(file), "clip")
    made.add_type(gguf.GGUFType.MMPROJ)
    made.add_clip_has_vision_encoder(True)
    made.add_vision_use_gelu(True)
    made.add_vision_attention_layernorm_eps(1e-6)
    made.add_vision_projection_dim(config.text_config.hidden_size)
    made.add_vision_patch_size(vision.patch_size)
    made.add_vision_embedding_length(vision.hidden_size)
    made.add_vision_feed_forward_length(vision.intermediate_size)
    made.add_vision_image_mean(list(pixels.image_mean))
    made.add_vision_image_std(list(pixels.image_std))
    gemma = config.model_type == "gemma3"
    if gemma:
        made.add_clip_projector_type("gemma3")
        made.add_vision_image_size(vision.image_size)
        made.add_vision_block_count(vision.num_hidden_layers)
        made.add_vision_head_count(vision.num_attention_heads)
        side = int(config.mm_tokens_per_image**0.5)
        made.add_vision_projector_scale_factor(vision.image_size // vision.patch_size // side)
    else:
        made.add_clip_projector_type("qwen3vl_merger")
        made.add_vision_image_size(int(vision.num_position_embeddings**0.5) * vision.patch_size)
        made.add_vision_block_count(vision.depth)
        made.add_vision_head_count(vision.num_heads)
        made.add_vision_spatial_merge_size(vision.spatial_merge_size)
        stacked = vision.deepstack_visual_indexes
        made.add_vision_is_deepstack_layers([layer in stacked for layer in range(vision.depth)])
    for name, weight in model.state_dict().items():
        for named, values in _named(name, weight, _SIGLIP if gemma else _QWEN3):
            plus = 1.0 if named == "mm.soft_emb_norm.weight" else 0.0  # Gemma's norms scale by 1 + weight
            made.add_tensor(named, np.ascontiguousarray(values.float().numpy() + plus, dtype=np.float32))
    return gguf_file.finished(made, file)


def _named(name: str, weight: Any, table: dict[str, str]) -> list[tuple[str, Any]]:
    if name == "model.visual.patch_embed.proj.weight":  # one kernel for each of the two moments of a video
        return [("v.patch_embd.weight", weight[:, :, 0]), ("v.patch_embd.weight.1", weight[:, :, 1])]
    if name == "model.visual.patch_embed.proj.bias":
        return [("v.patch_embd.bias", weight)]
    stem, dot, last = name.rpartition(".")
    for known, named in table.items():
        if re.fullmatch(known, name):
            return [(re.sub(known, named, name), weight)]
        if dot and re.fullmatch(known, stem):
            return [(f"{re.sub(known, named, stem)}.{last}", weight)]
    return []
