"""GGUF models and their files for pictures."""
