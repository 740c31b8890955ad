"""A Llama of transformers written as one GGUF file, as llama.cpp's converter writes it: no download, nothing packed."""

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
}  # fmt: skip
TEMPLATE = "{% for m in messages %}{{ m.role }}: {{ m.content }}\n{% endfor %}"


def write(file: Path, model: Any, tokenizer: Any) -> Path:
    """Writes config, tokenizer and weights (float32); needs the package gguf."""
    import gguf

    made = gguf.GGUFWriter(str(file), "llama")
    _shapes(made, model.config)
    _words(made, tokenizer, model.config.vocab_size)
    heads = {"attn_q": model.config.num_attention_heads, "attn_k": model.config.num_key_value_heads}
    for name, weight in model.state_dict().items():
        named = _named(name)
        values = weight.float().numpy()
        if (part := named.split(".")[-2]) in heads:
            values = _rotated(values, heads[part])
        made.add_tensor(named, np.ascontiguousarray(values, dtype=np.float32))
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
    made.add_rope_freq_base(10000.0)
    made.add_rope_dimension_count(config.hidden_size // config.num_attention_heads)
    made.add_vocab_size(config.vocab_size)


def _words(made: Any, tokenizer: Any, size: int) -> None:
    """The vocabulary; transformers' reader adds <|endoftext|> where a file of GPT-2's kind lacks it."""
    known = tokenizer.convert_ids_to_tokens(range(len(tokenizer)))
    more = [f"<extra{i}>" for i in range(size - len(known) - 1)] + ["<|endoftext|>"]
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
    made.add_chat_template(TEMPLATE)


def _named(name: str) -> str:
    if name in _WHOLE:
        return _WHOLE[name]
    _, _, layer, *rest = name.split(".")
    return f"blk.{layer}.{_LAYER['.'.join(rest).removesuffix('.weight')]}.weight"


def _rotated(values: Any, heads: int) -> Any:
    """Rows in llama.cpp's order of rotary pairs: neighbors instead of halves."""
    rows = values.shape[0]
    return values.reshape(heads, 2, rows // heads // 2, *values.shape[1:]).swapaxes(1, 2).reshape(values.shape)
