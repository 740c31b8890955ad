"""Which vision-language families run: each with tiny random weights, or refused by name before weights are read.

    python -m research.benchmarks.decoding.families [NAMES ...]

A family passes if all of this holds: greedy tokens behind a picture are those of transformers' own generation; both
rows under CAD give the tokens of two passes without a cache; reports in one batch get the answers that they get alone;
answers keep their schema; a repair gives the answer of a model that has kept nothing. Weights are random, so nothing
here says how well a family reads.
"""

from __future__ import annotations

import argparse
import inspect
import io
import json
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
import transformers as tf
from PIL import Image

from plugins.backbone import hf_run
from plugins.backbone.engine.check import _forget_positions, reference
from plugins.backbone.engine.families import CrossAttentionFamily, forward_inputs
from plugins.backbone.engine.records import Prompt, Request
from plugins.backbone.hf_vision import HfVision
from plugins.backbone.prompt import parts
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from research.benchmarks.decoding.family_models import FAMILIES, FamilyModel, save
from sgcad_core.case.records import Context, Diagram, Query
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Decoder

CHECKS = ("greedy", "both rows", "batch", "grammar", "repair")
_TOKENS = 12
_REPORTS = 3
_SCHEMA = {
    "type": "object",
    "properties": {
        "bearing": {"enum": ["N", "NE", "E", "SE", "S"]},
        "lanes_in": {"type": "integer", "minimum": 0, "maximum": 12},
        "name": {"type": "string", "maxLength": 6},
    },
    "required": ["bearing", "lanes_in", "name"],
    "additionalProperties": False,
}
_QUERY = Query(task="Describe the road.", answer_schema=_SCHEMA)


@dataclass(frozen=True)
class Row:
    """What became of a family: the checks that hold, or why it is refused."""

    family: FamilyModel
    held: frozenset[str] = field(default_factory=frozenset)
    refused: str = ""

    @property
    def passes(self) -> bool:
        """Whether every check holds."""
        return self.held == set(CHECKS)

    def line(self) -> str:
        """A row of the table in Markdown."""
        about = self.refused or ("passes" if self.passes else "**does not pass**")
        marks = ["–" if self.refused else "yes" if name in self.held else "**no**" for name in CHECKS]
        return f"| {' | '.join([self.family.name, f'`{self.family.model_type}`', *marks, about])} |"


class Bench:
    """One tiny model: its loop and its prompts."""

    def __init__(self, folder: Path) -> None:
        how = {"device": "cpu", "quantization": "none", "reports_at_once": 4, "pictures_first": True}
        settings = hf_run.options("float32", "sdpa", None)
        self.running = hf_run.start_model(str(folder), None, settings, prefix_bytes=1 << 26, **how)
        self.model, self.family = self.running.prompter.loaded.model, self.running.prompter.family
        self.folder = folder

    def held(self) -> Iterable[str]:
        """The names of the checks that hold."""
        checks = (self.greedy, self.both_rows, self.batch, self.grammar, self.repair)
        return (name for name, check in zip(CHECKS, checks, strict=True) if check())

    def greedy(self) -> bool:
        """The tokens of transformers' own generation, with one picture and with two."""
        return all(
            self._answer(prompt, None, Greedy()) == self._generated(prompt)
            for prompt in (self._prompt(context(0)), self._prompt(context(1, pictures=2)))
        )

    def both_rows(self) -> bool:
        """The tokens of two passes for each, without a cache."""
        prompts = self._prompt(context(2)), self._prompt(None)
        ids: list[int] = []
        for _ in range(_TOKENS):
            with_, without = (reference(self.model, self.family, prompt, ids)[-1:] for prompt in prompts)
            token = int(torch.argmax(Cad(alpha=0.7).scores(with_, without)))
            if token in self.running.eos:
                break
            ids.append(token)
        return self._answer(*prompts, Cad(alpha=0.7)) == ids

    def batch(self) -> bool:
        """Reports side by side, some without a picture, answered as one after the other."""
        contexts = [context(i, pictures=i % 2) for i in range(_REPORTS)]
        alone = [self._text(self._backbone(0), one, _QUERY) for one in contexts]
        backbone = self._backbone(1)
        with ThreadPoolExecutor(_REPORTS) as pool:
            return alone == list(pool.map(lambda one: self._text(backbone, one, _QUERY), contexts))

    def grammar(self) -> bool:
        """An answer that keeps its schema."""
        answer = json.loads(self._text(self._backbone(1), context(3), _QUERY))
        return list(answer) == _SCHEMA["required"] and answer["bearing"] in ("N", "NE", "E", "SE", "S")

    def repair(self) -> bool:
        """A further attempt on what is kept, and one of a model that has kept nothing."""
        backbone = self._backbone(1)
        first = self._text(backbone, context(4), _QUERY)
        again = _QUERY.model_copy(update={"repair": f"Mend this: {first}", "attempt": 2})
        return self._text(backbone, context(4), again) == self._text(self._backbone(0), context(4), again)

    def _backbone(self, kept_mb: int) -> HfVision:
        return HfVision(
            model=str(self.folder), device="cpu", dtype="float32", max_new_tokens=120, prefix_cache_mb=kept_mb
        )

    def _text(self, backbone: HfVision, of: Context, query: Query) -> str:
        return backbone.generate(of, query, Cad(alpha=0.7)).text

    def _prompt(self, of: Context | None) -> Prompt:
        return self.running.prompter.prompt(parts(of, _QUERY))

    def _answer(self, prompt: Prompt, without: Prompt | None, decoder: Decoder) -> list[int]:
        request = Request(prompt, without, decoder, None, 0, _TOKENS, self.running.eos)
        return list(self.running.engine.generate(request).ids)

    @torch.inference_mode()
    def _generated(self, prompt: Prompt) -> list[int]:
        ids = torch.tensor([list(prompt.ids)])
        taken = inspect.signature(self.model.forward).parameters
        inputs = {k: v for k, v in forward_inputs(prompt.pictures).items() if k in taken}
        if self.family.kinds_argument:
            inputs[self.family.kinds_argument] = ids.eq(self.family.image_token or 0).int()
        if isinstance(self.family, CrossAttentionFamily):
            inputs["cross_attention_mask"] = self.family.visible(prompt)[None]
        _forget_positions(self.model)
        made = self.model.generate(
            input_ids=ids, attention_mask=torch.ones_like(ids), max_new_tokens=_TOKENS, do_sample=False, **inputs
        )
        _forget_positions(self.model)
        found: list[int] = made[0, ids.shape[1] :].tolist()
        ends = [i for i, token in enumerate(found) if token in self.running.eos]
        return found[: ends[0]] if ends else found


def context(seed: int, pictures: int = 1) -> Context:
    """A short report with random pictures."""
    heading = ("north", "south", "east", "west")[seed % 4]
    narrative = f"V{seed} drove {heading} and struck V{seed + 1} at the crossing of two roads."
    return Context(narrative=narrative, diagrams=tuple(_diagram(10 * seed + i) for i in range(pictures)))


def _diagram(seed: int, width: int = 40, height: int = 24) -> Diagram:
    pixels = np.random.default_rng(seed).integers(0, 255, (height, width, 3), dtype=np.uint8)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="PNG")
    return Diagram(png=out.getvalue(), width_px=width, height_px=height)


def row_of(family: FamilyModel) -> Row:
    """Runs one family, or says why it is refused."""
    with tempfile.TemporaryDirectory() as folder:
        save(family, Path(folder))
        try:
            bench = Bench(Path(folder))
        except ConfigError as fault:
            return Row(family, refused="refused: " + str(fault).removeprefix(f"backbone.model {folder}: "))
        held = frozenset(bench.held())
        bench.running.engine.end()
        return Row(family, held)


def table(rows: Sequence[Row]) -> str:
    """The table in Markdown, with its count."""
    head = f"| family | model type | {' | '.join(CHECKS)} | result |\n|{'---|' * (len(CHECKS) + 3)}"
    refused = sum(bool(row.refused) for row in rows)
    count = f"{sum(row.passes for row in rows)} of {len(rows)} families pass, {refused} are refused by name."
    return "\n".join([head, *(row.line() for row in rows), "", count])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 if a family neither passes nor is refused."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("names", nargs="*", help="families; without: all")
    told = known.parse_args(arguments)
    torch.set_num_threads(1)
    tf.utils.logging.set_verbosity_error()
    tf.utils.logging.disable_progress_bar()
    rows = [row_of(family) for family in FAMILIES if not told.names or family.name in told.names]
    sys.stdout.write(f"{table(rows)}\n")
    return 0 if all(row.passes or row.refused for row in rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())
