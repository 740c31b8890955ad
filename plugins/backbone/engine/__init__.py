"""The token loop of every backbone that gives logits.

Two rows a report (with and without its evidence) in one batch, many reports at once, a grammar, and
prompts of which nothing is computed twice. Imports torch, transformers and numpy, and llguidance only where
a grammar is asked for: no pydantic, so that the benchmark runs on a bare machine with a GPU.
"""
