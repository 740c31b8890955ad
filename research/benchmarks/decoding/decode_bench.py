"""One model under the decoding benchmark: its requests, timed, with tokens and memory counted."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import torch

from plugins.backbone.engine.faults import EngineFault
from plugins.backbone.engine.loop import Engine, engine_of
from plugins.backbone.engine.records import Answer, Prompt, Request
from research.benchmarks.decoding import decode_setup as setup

ALPHA = 0.7
TOKENS = 48
REPAIR = 60
"""Tokens of a repair's findings, besides the answer before."""
_GB = 1e9
_CLOCKS: dict[str, Callable[[], float]] = {"wall": time.perf_counter, "process": time.process_time}
_clock = ["wall"]


def use_clock(name: str) -> None:
    """Choose what a second is: of the wall, or of this process's own work."""
    _clock[0] = name


def clock_name() -> str:
    """The chosen clock: "wall" or "process"."""
    return _clock[0]


def now() -> float:
    """Seconds on the chosen clock."""
    return _CLOCKS[_clock[0]]()


@dataclass(frozen=True)
class Row:
    """One arm: seconds a token without prefill, tokens a second with it, model calls a token, peak memory."""

    name: str
    token_s: float
    rate: float
    calls: float
    peak_gb: float


def missing(name: str) -> Row:
    """A row for which something is not installed."""
    return Row(name, float("nan"), float("nan"), float("nan"), float("nan"))


def synchronize(device: torch.device) -> None:
    """Wait for what a GPU still has to do."""
    if device.type == "cuda":
        torch.cuda.synchronize(device)


def reset_peak(device: torch.device) -> None:
    """Start a new maximum of device memory (a process's own maximum cannot be reset)."""
    if device.type == "cuda":
        torch.cuda.reset_peak_memory_stats(device)


def peak_gb(device: torch.device) -> float:
    """The most memory held: on a GPU since `reset_peak`, else by the process so far."""
    if device.type == "cuda":
        return torch.cuda.max_memory_allocated(device) / _GB
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / _GB


@dataclass
class Teacher:
    """Scores as cad (or greedy) does, draws as they do, then says the wanted token."""

    engine: Engine
    wanted: Sequence[int]
    alpha: float

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        if without_context is None or self.alpha == 0.0:
            return with_context
        return with_context + self.alpha * (with_context - without_context)

    def draw(self, scores: Any, generator: Any) -> Any:
        picked = scores.argmax(-1)
        job = next(job for job in self.engine.jobs if job.request.policy is self)
        told = self.wanted[min(job.place, len(self.wanted) - 1)]
        return 0 * picked + told

    def reads_prior(self) -> bool:
        return self.alpha > 0.0


@dataclass(frozen=True)
class Arm:
    """One way to answer."""

    rows: int = 2
    grammar: bool = False
    jump_forward: bool = False
    tokens: int = TOKENS
    """Without a grammar: how many; with one, the whole answer is written."""


@dataclass
class Bench:
    """One model and what every arm needs."""

    size: setup.Size
    device: torch.device
    rounds: int
    model: Any = field(init=False)
    family: Any = field(init=False)
    language: setup.Language = field(init=False)

    def __post_init__(self) -> None:
        self.model, self.family = setup.build(self.size, self.device)
        self.language = setup.language(self.size.text["vocab_size"])

    def engine(self, apart: bool = False, prefix_bytes: int = 0) -> Engine:
        return engine_of(self.model, self.family, apart, 16, prefix_bytes)

    def request(
        self, engine: Engine, prompts: tuple[Prompt, Prompt], arm: Arm, cut: int | None = None, **fields: Any
    ) -> Request:
        """`cut` stops after that many tokens, which measures the prefill."""
        wanted = fields.pop("wanted", self.language.answer)
        wanted = wanted if arm.grammar else wanted[: arm.tokens]
        grammar = self.language.maker.grammar(setup.SCHEMA) if arm.grammar else None
        teacher = Teacher(engine, wanted, ALPHA if arm.rows > 1 else 0.0)
        second = prompts[1] if arm.rows > 1 else None
        limit = cut or (4 * len(wanted) if grammar else len(wanted))
        return Request(
            prompts[0], second, teacher, grammar, 0, limit, frozenset([2]), jump_forward=arm.jump_forward, **fields
        )

    def timed(self, engine: Engine, requests: Sequence[Request]) -> tuple[float, list[Answer]]:
        """Wall seconds of requests submitted together, and their answers (none of those that were cut)."""
        synchronize(self.device)
        started = now()
        futures = [engine.submit(request) for request in requests]
        answers = []
        for future in futures:
            try:
                answers.append(future.result())
            except EngineFault:  # cut short within a grammar: only its time is wanted
                continue
        synchronize(self.device)
        return now() - started, answers

    def decode(self, arm: Arm, reports: int = 1, apart: bool = False) -> Row:
        """Seconds a token of an arm, its prefill taken off: the best of the rounds of each."""
        engine = self.engine(apart)
        prompts = [setup.report(self.size, i) for i in range(reports)]
        reset_peak(self.device)
        whole, prefill = float("inf"), float("inf")
        answers: list[Answer] = []
        for _ in range(self.rounds):
            seconds, _ = self.timed(engine, [self.request(engine, p, arm, cut=1) for p in prompts])
            prefill = min(prefill, seconds)
            seconds, answers = self.timed(engine, [self.request(engine, p, arm) for p in prompts])
            whole = min(whole, seconds)
        engine.close()
        tokens = sum(len(answer.ids) for answer in answers)
        calls = max(answer.model_calls for answer in answers) / len(answers[0].ids)
        return Row("", (whole - prefill) / tokens, tokens / whole, calls, peak_gb(self.device))
