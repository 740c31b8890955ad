"""Benchmarks of decoding, retrieval, the evidence gate and the model."""
