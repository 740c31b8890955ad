"""The token loop of every backbone that gives logits.

Two rows for each report (with and without its evidence) in one batch, many reports at once, a grammar, and reuse of
everything computed for earlier prompts. Imports torch, transformers and numpy, and llguidance only for a grammar; no
pydantic, so that the benchmark runs on a machine with a GPU and few packages.
"""
