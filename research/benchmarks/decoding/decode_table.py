"""Rows and figures of the decoding benchmark's tables, and the floors that a device sets."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
import transformers

from plugins.backbone.engine.records import Answer
from research.benchmarks.decoding.decode_bench import Bench, Row, clock_name, now


def attempt(name: str, seconds: float, first_s: float, answer: Answer) -> tuple[str, ...]:
    """One line of the attempts' table."""
    prompt = f"{answer.reused_tokens} of {answer.prompt_tokens}"
    return name, f"{1e3 * seconds:.0f}", f"{100 * seconds / first_s:.0f} %", prompt, str(answer.model_calls)


def heading(device: torch.device) -> str:
    """What was measured on what."""
    card = torch.cuda.get_device_name(device) if device.type == "cuda" else f"CPU, {torch.get_num_threads()} threads"
    versions = f"Python {platform.python_version()}, torch {torch.__version__}, transformers {transformers.__version__}"
    return (
        "# Decoding: measured\n\n"
        f"{card}; load {os.getloadavg()[0]:.1f} at the start; {versions}. Random weights of real shapes, one written "
        f"answer for all arms; the best of several rounds, {clock_name()} seconds. Ratios are against greedy on "
        "the same loop and mean more than milliseconds.\n"
    )


def section(bench: Bench, parts: Sequence[Any], grammar: str, floors: str) -> str:
    """One model's tables."""
    one, many, attempts = parts
    base = one[0].token_s
    count = sum(p.numel() for p in bench.model.parameters()) / 1e6
    size = bench.size
    picture = size.grid[0] * size.grid[1] // 4
    lines = [
        f"\n## {size.name} ({count:.0f}M parameters)\n",
        f"Prompt: {size.passages} tokens of task and passages in both rows, {picture} of picture and {size.narrative} "
        f"of narrative in one; answer {len(bench.language.answer)} tokens of JSON (48 without a grammar).\n",
        "| one report | ms a token | against greedy | model calls a token | peak memory GB |",
        "|---|---|---|---|---|",
        *(_line(row, base) for row in one),
        "",
        "| reports at once | ms a token | tokens/s with prefill | throughput against one | peak memory GB |",
        "|---|---|---|---|---|",
        *(
            f"| {r.name} | {1e3 * r.token_s:.2f} | {r.rate:.0f} | {r.rate / many[0].rate:.2f} | {r.peak_gb:.2f} |"
            for r in many
        ),
        "",
        "| attempt, prefill and picture included | ms | share | prompt tokens reused | model calls |",
        "|---|---|---|---|---|",
        *(f"| {' | '.join(line)} |" for line in attempts),
        "",
        grammar,
        floors,
    ]
    return "\n".join(line for line in lines if line is not None) + "\n"


def _line(row: Row, base: float) -> str:
    if row.token_s != row.token_s:
        return f"| {row.name} | not measured | | | |"
    return f"| {row.name} | {1e3 * row.token_s:.2f} | {row.token_s / base:.2f} | {row.calls:.2f} | {row.peak_gb:.2f} |"


# ------------------------------------------------------------------ single figures
def grammar_cost(bench: Bench) -> str:
    """Milliseconds a token of masking, and the share of tokens that need no model call."""
    if bench.language.maker is None:
        return "Grammar: not measured (llguidance is not installed)."
    from plugins.backbone.engine.grammar import allowed
    from research.benchmarks.decoding.decode_setup import SCHEMA

    vocabulary = bench.language.vocabulary
    started = now()
    grammar = bench.language.maker.grammar(json.loads(json.dumps(SCHEMA)))
    track = grammar.track()
    mask = np.zeros((1, (vocabulary + 31) // 32), np.int32)
    scores = torch.randn(1, vocabulary, device=bench.device)
    spent = []
    for token in bench.language.answer:
        started = now()
        track.fill(mask[0])
        scores.masked_fill(~allowed(mask, vocabulary, bench.device), float("-inf"))
        track.take(token)
        spent.append(now() - started)
    forced = jumped(bench)
    return (
        f"Grammar at a vocabulary of {vocabulary:,}: {1e3 * float(np.median(spent)):.3f} ms a masked token (mask, "
        f"unpack, apply). Jump-forward: {forced} of {len(bench.language.answer)} tokens "
        f"({100 * forced / len(bench.language.answer):.0f} %) need no model call of their own."
    )


def jumped(bench: Bench) -> int:
    """How many of the answer's tokens the grammar forces."""
    from research.benchmarks.decoding.decode_setup import SCHEMA

    track = bench.language.maker.grammar(SCHEMA).track()
    at = forced = 0
    while at < len(bench.language.answer):
        run = track.forced()
        forced, at = forced + len(run), at + len(run)
        if at < len(bench.language.answer) and not track.done:
            track.take(bench.language.answer[at])
            at += 1
    return forced


@torch.inference_mode()
def floors(bench: Bench) -> str:
    """What the device allows: reading the weights once a token, and the prefill's multiplications."""
    weights = sum(p.numel() * p.element_size() for n, p in bench.model.named_parameters() if "visual" not in n)
    if not bench.model.config.tie_word_embeddings:
        embedding = bench.model.get_input_embeddings().weight
        weights -= embedding.numel() * embedding.element_size()
    bandwidth, flops = _bandwidth(bench.device), _flops(bench.device, bench.size.dtype)
    tokens = bench.size.passages + bench.size.narrative + bench.size.grid[0] * bench.size.grid[1] // 4
    body = sum(p.numel() for n, p in bench.model.named_parameters() if "layers" in n and "visual" not in n)
    return (
        f"\nFloors: {weights / 1e9:.2f} GB of weights at {bandwidth / 1e9:.0f} GB/s read = "
        f"{1e3 * weights / bandwidth:.2f} ms a token; {tokens} prompt tokens at {flops / 1e12:.2f} TFLOP/s = "
        f"{1e3 * 2 * body * tokens / flops:.0f} ms of prefill."
    )


def _bandwidth(device: torch.device) -> float:
    """Bytes read a second, by summing a large tensor."""
    data = torch.ones((1 << 30 if device.type == "cuda" else 1 << 27) // 4, device=device)
    return data.numel() * 4 / _best(lambda: data.sum(), device)


def _flops(device: torch.device, dtype: torch.dtype) -> float:
    side = 8192 if device.type == "cuda" else 1024
    left = torch.randn(side, side, device=device, dtype=dtype)
    return 2 * side**3 / _best(lambda: left @ left, device)


def _best(work: Any, device: torch.device) -> float:
    found = float("inf")
    for _ in range(6):
        started = now()
        work()
        if device.type == "cuda":
            torch.cuda.synchronize(device)
        found = min(found, now() - started)
    return found
