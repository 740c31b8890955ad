"""The arms of one report in turn, each over greedy's time in the same turn: ratios that a busy machine hardly moves.

The prompt is kept, so that a turn decodes and nothing else; what a request costs besides is taken off.
"""

from __future__ import annotations

from statistics import median

from plugins.backbone.engine.loop import Engine
from research.benchmarks.decoding import decode_setup as setup
from research.benchmarks.decoding.decode_bench import Arm, Bench, clock_name

GREEDY = "greedy"
_KEPT_BYTES = 4 << 30


def arms(bench: Bench) -> dict[str, Arm]:
    """Names of arms, greedy first; those with a grammar only where there are grammars."""
    found = {GREEDY: Arm(rows=1), "cad, both rows in one batch": Arm()}
    if bench.language.maker is not None:
        found["greedy with grammar and jump-forward"] = Arm(rows=1, grammar=True, jump_forward=True)
        found["cad with grammar and jump-forward"] = Arm(grammar=True, jump_forward=True)
    return found


def table(bench: Bench, turns: int) -> str:
    """A table of that many turns behind one that is not counted."""
    engine = bench.engine(prefix_bytes=_KEPT_BYTES)
    known = arms(bench)
    for arm in known.values():
        _each(bench, engine, arm)
    found: dict[str, list[float]] = {name: [] for name in known}
    calls: dict[str, float] = {}
    for _ in range(turns):
        for name, arm in known.items():
            seconds, calls[name] = _each(bench, engine, arm)
            found[name].append(seconds)
    engine.close()
    lines = [
        f"\n## {bench.size.name}: {turns} turns, {clock_name()} seconds\n",
        "| arm | ms a token, median | against greedy of the same turn: median | least | most | model calls a token |",
        "|---|---|---|---|---|---|",
    ]
    for name, seconds in found.items():
        ratios = [one / base for one, base in zip(seconds, found[GREEDY], strict=True)]
        figures = f"{1e3 * median(seconds):.2f} | {median(ratios):.3f} | {min(ratios):.3f} | {max(ratios):.3f}"
        lines.append(f"| {name} | {figures} | {calls[name]:.2f} |")
    return "\n".join(lines) + "\n"


def _each(bench: Bench, engine: Engine, arm: Arm) -> tuple[float, float]:
    """Seconds and model calls a token of one answer."""
    prompts = setup.report(bench.size, 0)
    before, _ = bench.timed(engine, [bench.request(engine, prompts, arm, cut=1)])
    seconds, (answer,) = bench.timed(engine, [bench.request(engine, prompts, arm)])
    return (seconds - before) / len(answer.ids), answer.model_calls / len(answer.ids)
