"""A text model of transformers as one GGUF file, as llama.cpp's converter writes it: no download, nothing packed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

_WHOLE = {
    "model.embed_tokens.weight": "token_embd.weight",
    "model.norm.weight": "output_norm.weight",
    "lm_head.weight": "output.weight",
}
_LAYER = {
    "self_attn.q_proj": "attn_q", "self_attn.k_proj": "attn_k", "self_attn.v_proj": "attn_v",
    "self_attn.o_proj": "attn_output", "mlp.gate_proj": "ffn_gate", "mlp.up_proj": "ffn_up",
    "mlp.down_proj": "ffn_down", "input_layernorm": "attn_norm", "post_attention_layernorm": "ffn_norm",
    "self_attn.q_norm": "attn_q_norm", "self_attn.k_norm": "attn_k_norm",
}  # fmt: skip
_GEMMA = {
    "post_attention_layernorm": "post_attention_norm", "pre_feedforward_layernorm": "ffn_norm",
    "post_feedforward_layernorm": "post_ffw_norm",
}  # fmt: skip
TEMPLATE = "{% for m in messages %}{{ m.role }}: {{ m.content }}\n{% endfor %}"


def write(file: Path, model: Any, tokenizer: Any, kind: str = "llama", template: str = TEMPLATE) -> Path:
    """Writes config, tokenizer and weights (float32) of a Llama or of a tiny Qwen3-VL's or Gemma 3's language model.

    Needs the package gguf.
    """
    import gguf

    config = getattr(model.config, "text_config", model.config)
    made = gguf.GGUFWriter(str(file), kind)
    _shapes(made, config)
    if kind == "qwen3vl":
        made.add_rope_dimension_sections([*config.rope_parameters["mrope_section"], 0])
        made.add_num_deepstack_layers(len(model.config.vision_config.deepstack_visual_indexes))
    if kind == "gemma3":
        made.add_sliding_window(config.sliding_window)
        made.add_sliding_window_pattern([layer == "sliding_attention" for layer in config.layer_types])
        made.add_rope_freq_base(config.rope_parameters["full_attention"]["rope_theta"])
    else:
        made.add_rope_freq_base(10000.0)
    _words(made, tokenizer, config.vocab_size, template)
    heads = {"attn_q": config.num_attention_heads, "attn_k": config.num_key_value_heads}
    for name, weight in model.state_dict().items():
        if "vision" in name or "visual" in name or "projector" in name:
            continue
        named = _named(name.replace("language_model.", ""), {**_LAYER, **(_GEMMA if kind == "gemma3" else {})})
        values = weight.float().numpy()
        values = values + 1.0 if kind == "gemma3" and "norm" in named else values  # Gemma's norms scale by 1 + weight
        if kind == "llama" and (part := named.split(".")[-2]) in heads:
            values = _rotated(values, heads[part])
        made.add_tensor(named, np.ascontiguousarray(values, dtype=np.float32))
    return finished(made, file)


def finished(made: Any, file: Path) -> Path:
    """Writes what a writer of the package gguf was given."""
    made.write_header_to_file()
    made.write_kv_data_to_file()
    made.write_tensors_to_file()
    made.close()
    return file


def _shapes(made: Any, config: Any) -> None:
    made.add_context_length(config.max_position_embeddings)
    made.add_embedding_length(config.hidden_size)
    made.add_block_count(config.num_hidden_layers)
    made.add_feed_forward_length(config.intermediate_size)
    made.add_head_count(config.num_attention_heads)
    made.add_head_count_kv(config.num_key_value_heads)
    made.add_layer_norm_rms_eps(config.rms_norm_eps)
    made.add_rope_dimension_count(config.hidden_size // config.num_attention_heads)
    made.add_key_length(config.hidden_size // config.num_attention_heads)
    made.add_value_length(config.hidden_size // config.num_attention_heads)
    made.add_vocab_size(config.vocab_size)


def whole(tokenizer: Any, size: int) -> list[str]:
    """Names for the ids behind a tokenizer's own, the last of them GPT-2's end of a text; none where it has all."""
    left = size - len(tokenizer)
    return [f"<extra{i}>" for i in range(left - 1)] + ["<|endoftext|>"] if left else []


def _words(made: Any, tokenizer: Any, size: int, template: str) -> None:
    """The vocabulary; transformers' reader adds <|endoftext|> where a file of GPT-2's kind lacks it."""
    known = tokenizer.convert_ids_to_tokens(range(len(tokenizer)))
    more = whole(tokenizer, size)
    merges = json.loads(tokenizer.backend_tokenizer.to_str())["model"]["merges"]
    specials = set(tokenizer.all_special_tokens) | {t.content for t in tokenizer.added_tokens_decoder.values()}
    control, normal = 3, 1
    made.add_tokenizer_model("gpt2")
    made.add_tokenizer_pre("gpt-2")
    made.add_token_list([*known, *more])
    made.add_token_types([control if t in specials or t in more else normal for t in (*known, *more)])
    made.add_token_merges([" ".join(pair) if isinstance(pair, list) else pair for pair in merges])
    made.add_bos_token_id(tokenizer.bos_token_id)
    made.add_eos_token_id(tokenizer.eos_token_id)
    made.add_pad_token_id(tokenizer.pad_token_id)
    made.add_chat_template(template)


def _named(name: str, layers: dict[str, str]) -> str:
    if name in _WHOLE:
        return _WHOLE[name]
    _, _, layer, *rest = name.split(".")
    return f"blk.{layer}.{layers['.'.join(rest).removesuffix('.weight')]}.weight"


def _rotated(values: Any, heads: int) -> Any:
    """Rows in llama.cpp's order of rotary pairs: neighbors instead of halves."""
    rows = values.shape[0]
    return values.reshape(heads, 2, rows // heads // 2, *values.shape[1:]).swapaxes(1, 2).reshape(values.shape)
