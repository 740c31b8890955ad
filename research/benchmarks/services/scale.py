"""What 10^4 and 10^6 reports a day need, and which part gives way first: the tables of docs/scale.md.

    python -m research.benchmarks.services.scale
    python -m research.benchmarks.services.scale --rate 1e5 --model 3 --set mlflow=0.02 --servers starter=2

Costs a case come from the benchmarks `stages`, `load` and `dask_tasks` of this folder; what a card can do is computed
from its data sheet and says so. The waiting is simulated (research/benchmarks/services/queueing.py).
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

from research.benchmarks.services.queueing import (
    DAY_S,
    PEAK,
    Outcome,
    Seen,
    Station,
    arrivals,
    servers_for,
    simulate,
    working_hours,
)

WAIT_S = 60.0
"""Mean wait that is put up with in the busiest hour."""
REPORTS = 50_000
"""As many are simulated at most."""


# ------------------------------------------------------------------ what a card can do at best
@dataclass(frozen=True)
class Card:
    """A graphics card or several that hold one model: bytes and operations a second, from its data sheet."""

    bytes_s: float
    operations_s: float


@dataclass(frozen=True)
class Model:
    """A vision-language model at work: computed floors, nothing measured on a card.

    `prompt` counts both rows of a stage, the diagram's tokens among them; `calls` are decoding steps a stage
    (jump-forward leaves 0.35 of the answer's tokens, docs/results-decoding.md); `rows` tokens go through a step.
    """

    parameters: float
    bytes_each: float
    prompt: int = 2000
    calls: int = 119
    rows: int = 6
    stages: int = 2

    def floor_s(self, card: Card, batch: int) -> float:
        """Least seconds a report: a step reads all weights once or computes the batch's tokens, whichever is longer."""
        step = max(
            self.parameters * self.bytes_each / card.bytes_s, self._operations(self.rows * batch) / card.operations_s
        )
        prefill = self._operations(self.prompt) / card.operations_s
        return self.stages * (prefill + self.calls * step / batch)

    def _operations(self, tokens: float) -> float:
        return 2 * self.parameters * tokens


H200 = Card(4.8e12, 0.989e15)
"""One card of 141 GB: 4.8 TB/s, 989 TFLOP/s in bfloat16 (data sheet)."""
QWEN_72B_INT4 = Model(72.7e9, 0.5)
QWEN_72B_BF16 = Model(72.7e9, 2.0)
TIMES_FLOOR = 3.0
"""What is planned with: a real card reaches a third of its floors. A guess until one is measured."""


# ------------------------------------------------------------------ the tables
@dataclass(frozen=True)
class Costs:
    """Processor seconds a report at each part, measured as docs/scale.md says; the storage's are a round trip."""

    chain: float = 0.88
    hand_in: float = 0.18
    dask: float = 0.010
    storage: float = 0.13
    prefect: float = 0.231
    mlflow: float = 0.171
    starter: float = 0.123


SHARED = {"storage": 64, "dask": 1, "prefect": 1, "mlflow": 1, "starter": 1}
"""Servers of the parts that all hosts share: requests at a time, processes."""


def stations_for(
    per_day: float, costs: Costs, model_s: float = 0.0, shared: dict[str, int] | None = None
) -> list[Station]:
    """The shared parts, and of cores (and cards) as many as the peak hour needs."""
    work = costs.chain + costs.hand_in
    cards = [Station("cards", servers_for(per_day, model_s, WAIT_S, PEAK), model_s, 0.3)] if model_s else []
    cores = Station("cores", servers_for(per_day, work, WAIT_S, PEAK), work, 0.5)
    parts = {**SHARED, **(shared or {})}
    return [*cards, cores, *(Station(name, parts[name], getattr(costs, name), 0.5) for name in SHARED)]


def day(
    per_day: float, stations: Sequence[Station], hours: float = 24.0, reports: int = REPORTS
) -> tuple[Outcome, str]:
    """A day from midnight, or as much of its peak as `reports` reports fill; and which it was."""
    if per_day * hours / 24 <= reports:
        times = [t for t in arrivals(per_day, reports, random.Random(7), working_hours) if t < hours * 3600]
        return simulate(stations, times, seed=7), "a whole day"
    return simulate(stations, list(arrivals(PEAK * per_day, reports, random.Random(7))), seed=7), "at the peak's rate"


def table(
    per_day: float,
    costs: Costs,
    model_s: float = 0.0,
    shared: dict[str, int] | None = None,
    reports: int = REPORTS,
) -> str:
    """A simulated day as Markdown."""
    outcome, what = day(per_day, stations_for(per_day, costs, model_s, shared), reports=reports)
    lines = [f"{per_day:,.0f} reports a day ({what}, {len(outcome.through):,} reports):", "",
             "| part | servers | s a report | most a day | busy | mean wait s | 99 % wait s | longest queue |",
             "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    lines += [_row(seen, outcome.elapsed_s) for seen in outcome.seen]
    through = sorted(outcome.through)
    median, late = through[len(through) // 2], through[int(0.99 * len(through))]
    first = max(outcome.seen, key=lambda seen: per_day / DAY_S / seen.station.capacity).station
    verdict = "cannot keep up" if first.capacity * DAY_S < per_day else "gives way first"
    lines += ["", f"From arrival to tracked result: median {median:.1f} s, 99 % {late:.1f} s. {first.name}: {verdict}."]
    return "\n".join(lines)


def _row(seen: Seen, elapsed_s: float) -> str:
    one = seen.station
    most = f"{one.capacity * DAY_S:,.0f}"
    waits = f"{seen.mean_wait:.2f} | {seen.quantile(0.99):.2f} | {seen.longest_queue:,}"
    return f"| {one.name} | {one.servers} | {one.seconds:.3f} | {most} | {seen.utilisation(elapsed_s):.0%} | {waits} |"


def cards() -> str:
    """Floors of a 72B model on one or two H200, as Markdown."""
    two = Card(2 * H200.bytes_s, 2 * H200.operations_s)
    kinds = (("int4, 45 GB, one card", QWEN_72B_INT4, H200), ("bfloat16, 150 GB, two cards", QWEN_72B_BF16, two))
    lines = [
        "| 72B in | reports at once | floor, s a report | a day at the floor | planned with |",
        "|---|---|---|---|---|",
    ]
    for name, model, card in kinds:
        for batch in (1, 4, 16):
            seconds = model.floor_s(card, batch)
            a_day = f"{DAY_S / seconds:,.0f} | {DAY_S / seconds / TIMES_FLOOR:,.0f}"
            lines.append(f"| {name} | {batch} | {seconds:.2f} | {a_day} |")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables of docs/scale.md."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rate", type=float, nargs="+", default=[1e4, 1e6], help="reports a day")
    parser.add_argument("--set", action="append", default=[], help="a cost, such as prefect=0.02")
    parser.add_argument("--servers", action="append", default=[], help="of a shared part, such as mlflow=4")
    parser.add_argument("--model", type=float, default=0.0, help="seconds a report on a card; 0: no model")
    options = parser.parse_args(arguments)
    costs = replace(Costs(), **{key: float(value) for key, _, value in (one.partition("=") for one in options.set)})
    shared = {key: int(value) for key, _, value in (one.partition("=") for one in options.servers)}
    parts = [table(rate, costs, options.model, shared) for rate in options.rate]
    sys.stdout.write("\n\n".join([*parts, cards()]) + "\n")


if __name__ == "__main__":
    main()
