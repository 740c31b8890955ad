"""What each decoder of the study `decoders` makes of the recorded reports: fields right, conflicts, and who won.

The study's model answers road and crash once (no refinement); its crash is compared with the one written by hand:
kinds and maneuvers of the actors, and the first contact. The gate's row says at how many tokens with a choice the row
without the report was needed.

    python -m research.benchmarks.decoding.conflicts [--arms grd cad ...] [--reports 12]
    python -m research.benchmarks.decoding.conflicts --study decoders_smollm2 --must-answer
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml
from pydantic import PrivateAttr

from flows.study_file.arm_config import load_config
from plugins.backbone.scripted import ASKED
from plugins.decoder.gated import Gated
from sgcad_core import config as configs
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, CrashReport, Generation, Query
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.interfaces import Backbone, Decoder
from sgcad_core.reading.text.privacy import redact
from sgcad_core.records.specs import BehaviorSpec, RoadLayout
from sgcad_core.roads.describe import road_ids
from sgcad_core.roads.layout import road_spec
from sgcad_core.settings import ROOT

RECORDED = ROOT / "tests" / "recorded"
ARMS = ("greedy", "greedy_masked", "cad", "cad_plausible", "adacad", "grd", "coiecd", "cocoa", "gated")


class CountedGate(Gated):
    """The gated contrast, counting tokens with a choice and those at which the gate was open."""

    _seen: Counter[str] = PrivateAttr(default_factory=Counter)

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """The same scores."""
        self._seen["all"] += len(with_context)
        self._seen["open"] += int(self.open(with_context).sum())
        return super().scores(with_context, without_context)

    @property
    def seen(self) -> Counter[str]:
        """`all` and `open`."""
        return self._seen


@dataclass
class Tally:
    """Counts of one arm."""

    right: int = 0
    asked: int = 0
    failed: int = 0
    conflicts: Counter[str] = field(default_factory=Counter)
    tokens: int = 0
    calls: int = 0
    cpu_s: float = 0.0

    def note(self, found: Generation) -> None:
        """Adds an answer's conflicts and cost."""
        self.conflicts.update(one.winner for one in found.conflicts)
        self.tokens += sum(not token.forced for token in found.tokens)
        self.calls += found.model_calls


def reports(count: int) -> Iterator[tuple[str, BehaviorSpec]]:
    """Redacted narratives with the behavior written by hand, every k-th of them so that all kinds are there."""
    files = [file for file in sorted((RECORDED / "answers").glob("*.yaml")) if file.name != ASKED]
    told = [one for file in files for one in yaml.safe_load(file.read_text(encoding="utf-8"))]
    told = [one for one in told if not one["scenario"][-1].get("near_crash")]
    for one in told[:: max(1, len(told) // count)][:count]:
        text = (RECORDED / "reports" / f"{one['case']}.txt").read_text(encoding="utf-8")
        yield redact(" ".join(text.split())), BehaviorSpec.model_validate(one["scenario"][-1])


def answered(backbone: Backbone, decoder: Decoder, narrative: str, tally: Tally, refusal: bool = True) -> BehaviorSpec:
    """The model's crash on its own road; with `refusal` it may refuse. Raises InvalidOutput, Refused."""
    context = Context.of(CrashReport(case="c", narrative=narrative))
    road = backbone.generate(
        context, Query(task=load_prompt("mini_road"), answer_schema=answer_schema(RoadLayout, refusal=refusal)), decoder
    )
    tally.note(road)
    layout = parse_answer(road.text, RoadLayout)
    ids = road_ids(road_spec(layout))
    schema = answer_schema(BehaviorSpec, enums={"road": ids, "exit_road": ids}, refusal=refusal)
    task = load_prompt("mini_scenario", roads=layout.model_dump_json())
    crash = backbone.generate(context, Query(task=task, answer_schema=schema), decoder)
    tally.note(crash)
    return parse_answer(crash.text, BehaviorSpec)


def compared(said: BehaviorSpec | None, told: BehaviorSpec) -> tuple[int, int]:
    """Fields right, and fields asked: kind and maneuver of each vehicle, the four fields of the first contact."""
    acting = {actor.id: actor for actor in said.actors} if said else {}
    vehicles = [actor for actor in told.actors if actor.id.startswith("V")]
    pairs = [
        (getattr(acting.get(v.id), name, None), getattr(v, name)) for v in vehicles for name in ("kind", "maneuver")
    ]
    first = said.contacts[0] if said and said.contacts else None
    fields = ("striker", "struck", "striker_area", "struck_area")
    pairs += [(getattr(first, name, None), getattr(told.contacts[0], name)) for name in fields]
    return sum(a == b for a, b in pairs), len(pairs)


def tallied(study: str, arm: str, count: int, refusal: bool) -> tuple[Tally, Decoder]:
    """One arm of a study over the reports; with `refusal` its model may refuse."""
    config = configs.build(load_config(f"{study}/{arm}").raw, arm, arm)
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:
        raise ConfigError(f"{study}/{arm}: asks no model; name arms of configs/studies/{study}.yaml that do")
    if isinstance(decoder, Gated):
        decoder = CountedGate(**decoder.model_dump())
    tally = Tally()
    for narrative, told in reports(count):
        started = time.process_time()
        try:
            said = answered(backbone, decoder.at(1), narrative, tally, refusal)
        except (InvalidOutput, Refused):
            said, tally.failed = None, tally.failed + 1
        tally.cpu_s += time.process_time() - started
        right, asked = compared(said, told)
        tally.right, tally.asked = tally.right + right, tally.asked + asked
    return tally, decoder


def main(argv: Sequence[str] | None = None) -> int:
    """Print the table in Markdown."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--study", default="decoders", help="a study of configs/studies with these arms")
    parser.add_argument("--arms", nargs="*", default=ARMS)
    parser.add_argument("--reports", type=int, default=12)
    parser.add_argument("--must-answer", action="store_true", help="the schema has no refusal: for untrained models")
    options = parser.parse_args(argv)
    print(  # noqa: T201 - a command prints
        "| decoder | fields right | tokens with a choice | conflicts | evidence | prior | neither | no answer | CPU s |"
    )
    print("|---|---|---|---|---|---|---|---|---|")  # noqa: T201 - a command prints
    for arm in options.arms:
        tally, decoder = tallied(options.study, arm, options.reports, not options.must_answer)
        won, n = tally.conflicts, sum(tally.conflicts.values())
        cells = [arm, f"{tally.right} of {tally.asked}", tally.tokens, n, won["evidence"], won["prior"], won["neither"],
                 tally.failed, f"{tally.cpu_s:.0f}"]  # fmt: skip
        print(f"| {' | '.join(map(str, cells))} |", flush=True)  # noqa: T201 - a command prints
        if isinstance(decoder, CountedGate):
            seen = decoder.seen
            print(  # noqa: T201 - a command prints
                f"\ngate open at {seen['open']} of {seen['all']} positions ({seen['open'] / max(seen['all'], 1):.0%})\n"
            )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
