"""LoRA adapters of language models: rows, model, training."""
