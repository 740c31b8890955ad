"""How fast is context-aware decoding? One table in one run, ratios against plain greedy on the same loop.

    python -m research.benchmarks.decoding.decode [--size 15m 200m | 7b] [--rounds 3] [--out docs/results-decoding.md]
    python -m research.benchmarks.decoding.decode --size 200m --turns 7 --threads 1 --clock process   # two ratios alone

Weights are random, shapes are real; a teacher policy makes every arm pay for its scoring and then write the
same answer, so arms differ in cost alone. Needs torch, transformers and numpy; rows that need more say "not
measured". No network. On a GPU: Qwen2.5-VL-7B's configuration and the card's two floors.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import torch

from plugins.backbone.engine.check import reference
from plugins.backbone.engine.records import Answer
from research.benchmarks.decoding import decode_setup as setup
from research.benchmarks.decoding import decode_table as table
from research.benchmarks.decoding.costs import in_turn
from research.benchmarks.decoding.decode_bench import (
    ALPHA,
    REPAIR,
    TOKENS,
    Arm,
    Bench,
    Row,
    missing,
    now,
    peak_gb,
    reset_peak,
    synchronize,
    use_clock,
)


# ------------------------------------------------------------------ arms
def one_report(bench: Bench) -> list[Row]:
    """Every way to decode one report."""
    loop = [
        ("greedy, one row: the base", Arm(rows=1), False),
        ("cad, both rows in one batch", Arm(), False),
        ("cad, two caches", Arm(), True),
    ]
    rows = [replace(bench.decode(arm, apart=apart), name=name) for name, arm, apart in loop]
    rows += [without_cache(bench), *guidance(bench)]
    if bench.language.maker is None:
        return [*rows, missing("cad with grammar"), missing("cad with grammar and jump-forward")]
    grammar = [
        ("greedy with grammar", Arm(rows=1, grammar=True)),
        ("cad with grammar", Arm(grammar=True)),
        ("cad with grammar and jump-forward", Arm(grammar=True, jump_forward=True)),
    ]
    return rows + [replace(bench.decode(arm), name=name) for name, arm in grammar]


@torch.inference_mode()
def without_cache(bench: Bench, tokens: int = 3) -> Row:
    """The reference: both rows anew for every token, from the middle of the answer."""
    prompts = setup.report(bench.size, 0)
    behind = bench.language.answer[: TOKENS // 2]
    reset_peak(bench.device)
    started = now()
    for i in range(tokens):
        for prompt in prompts:
            reference(bench.model, bench.family, prompt, [*behind, *behind[:i]]).argmax()
    synchronize(bench.device)
    seconds = (now() - started) / tokens
    return Row("two forwards without cache", seconds, 1 / seconds, 2.0, peak_gb(bench.device))


@torch.inference_mode()
def guidance(bench: Bench) -> list[Row]:
    """transformers' own guidance and greedy, on the model's text layers alone: on Qwen-VL itself it breaks."""
    twin = setup.text_twin(bench.model)
    with_, without = (
        torch.tensor([[t for t in prompt.ids if t != setup.IMAGE_TOKEN]], device=bench.device)
        for prompt in setup.report(bench.size, 0)
    )
    found = []
    for name, extra in (
        ("greedy", {}),
        ("guidance", {"guidance_scale": 1 + ALPHA, "negative_prompt_ids": without}),
    ):
        reset_peak(bench.device)
        seconds = [float("inf"), float("inf")]
        for _ in range(bench.rounds):
            for i, count in enumerate((4, TOKENS)):
                started = now()
                ones = torch.ones_like(with_)
                twin.generate(
                    input_ids=with_, attention_mask=ones, do_sample=False, min_new_tokens=count, max_new_tokens=count,
                    **extra,
                )  # fmt: skip
                synchronize(bench.device)
                seconds[i] = min(seconds[i], now() - started)
        each = (seconds[1] - seconds[0]) / (TOKENS - 4)
        calls = 2.0 if extra else 1.0
        name = f"transformers' {name}, text layers only"
        found.append(Row(name, each, TOKENS / seconds[1], calls, peak_gb(bench.device)))
    return found


def many_reports(bench: Bench, counts: Sequence[int]) -> list[Row]:
    """Reports at once, with grammar and jump-forward where there are any."""
    ready = bench.language.maker is not None
    arm = Arm(grammar=ready, jump_forward=ready)
    found = []
    for count in counts:
        row = bench.decode(arm, reports=count)
        found.append(replace(row, name=f"cad, {count} report{'s' if count > 1 else ''} at once"))
    return found


def attempts(bench: Bench) -> list[Row]:
    """A first attempt from nothing, and its repair: shared prompt, picture and most of the answer known."""
    names = ("first attempt", "its repair with draft", "its repair without draft", "its repair, nothing reused")
    best: dict[str, tuple[float, Answer]] = {}
    for i in range(bench.rounds):
        for name, seconds, answer in _attempted(bench, 50 + i, names):
            if name not in best or seconds < best[name][0]:
                best[name] = seconds, answer
    first_s = best[names[0]][0]
    return [table.attempt(name, best[name][0], first_s, best[name][1]) for name in names]


def _attempted(bench: Bench, seed: int, names: Sequence[str]) -> Iterator[tuple[str, float, Answer]]:
    """One report, each way to repair it behind a first attempt of its own, or alone."""
    ready = bench.language.maker is not None
    arm = Arm(grammar=ready, jump_forward=ready)
    first, again = setup.report(bench.size, seed), setup.report(bench.size, seed, REPAIR, bench.language.answer)
    for name in names[1:]:
        bench.family.kept.clear()
        alone = name == names[-1]
        engine = bench.engine(prefix_bytes=0 if alone else 4 << 30)
        draft: Sequence[int] = ()
        if not alone:
            seconds, (answer,) = bench.timed(engine, [bench.request(engine, first, arm)])
            draft = answer.ids if name == names[1] else ()
            yield names[0], seconds, answer
        request = bench.request(engine, again, arm, wanted=bench.language.mended, draft=draft)
        seconds, (answer,) = bench.timed(engine, [request])
        yield name, seconds, answer
        engine.close()


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print; `--out` also writes the table."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("--size", nargs="+", choices=sorted(setup.SIZES))
    known.add_argument("--reports", nargs="+", type=int, default=[1, 4, 16])
    known.add_argument("--rounds", type=int, default=3)
    known.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    known.add_argument("--out", type=Path)
    known.add_argument("--threads", type=int, help="threads of torch; its own choice if not given")
    known.add_argument(
        "--clock", choices=("wall", "process"), default="wall", help="process: seconds of CPU, for a busy machine"
    )
    known.add_argument("--turns", type=int, help="only greedy, CAD and grammar, in turn that many times")
    told = known.parse_args(arguments)
    if told.threads:
        torch.set_num_threads(told.threads)
    use_clock(told.clock)
    device = torch.device(told.device)
    sizes = told.size or (["7b"] if device.type == "cuda" else ["15m", "200m"])
    text = [table.heading(device)]
    for name in sizes:
        bench = Bench(setup.SIZES[name], device, told.rounds)
        if told.turns:
            text.append(in_turn.table(bench, told.turns))
            continue
        parts = [one_report(bench), many_reports(bench, told.reports), attempts(bench)]
        text.append(table.section(bench, parts, table.grammar_cost(bench), table.floors(bench)))
        sys.stderr.write(f"{name} done\n")
    sys.stdout.write("\n".join(text))
    if told.out:
        told.out.write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
