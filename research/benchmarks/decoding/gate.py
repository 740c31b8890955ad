"""Calibrates the evidence gate: how sure is a refusal, and where must the thresholds lie for a model?

    python -m research.benchmarks.decoding.gate CASES [CASES ...] --config configs/mini.yaml   # real reports
    python -m research.benchmarks.decoding.gate --made 60 --config configs/mini.yaml           # reports of mini's \
        generator

Every report goes at every robustness level through the first road and scenario answer of the config's model. Levels
that leave the crash readable should be answered, those that take it away refused. Half of the reports (by a hash
of their names) choose the thresholds, the other half says what they are worth. Groundings are kept line by line in a
file of this config and its weights: run again to go on, or with --precision to choose anew without asking the model.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

from flows.case.steps import ask_of
from flows.case_files.find_cases import cases_in
from plugins.report_reader.degrade import LEVELS, Level, degrade
from plugins.validator.evidence_gate import GROUPS, nats_of
from research.benchmarks.decoding.gate_sweep import Sample, Score, area, choose, halves, refused, score, sweep
from research.generator.report import Report, make_report
from sgcad_core import settings
from sgcad_core.case.records import Context, CrashReport, Diagram, Generation, Query
from sgcad_core.config import Config, load
from sgcad_core.errors import BadInput, ConfigError, InvalidOutput, MissingTool, Refused
from sgcad_core.interfaces import Ask

THIN: tuple[Level, ...] = ("critical_depletion", "total_sparsity")
"""Levels that should be refused; the others should be answered."""
NAMES = [group.field for groups in GROUPS.values() for group in groups]
FIRST_MADE = 60_000_000
"""Seeds of made reports: held out from training, and not those that the model's card is measured on."""


# ------------------------------------------------------------------ reports
def made(count: int) -> Iterator[CrashReport]:
    """Reports of mini's generator with text, and mostly with a drawing; phrases that no training saw."""
    for seed in range(FIRST_MADE, FIRST_MADE + count):
        yield as_report(make_report(seed, True, 0.6, {"both": 3.0, "text": 1.0}))


def as_report(report: Report) -> CrashReport:
    """A made report as readers give one, with its drawing if it has one."""
    from research.rows.row_stream import drawing  # loads torch, and --help should not wait for it

    picture = drawing(report)
    diagrams: tuple[Diagram, ...] = ()
    if picture is not None:
        out = io.BytesIO()
        picture.save(out, "PNG")
        diagrams = (Diagram(png=out.getvalue(), width_px=picture.width, height_px=picture.height),)
    return CrashReport(case=f"made-{report.seed}", narrative=report.narrative, diagrams=diagrams)


def read(config: Config, folders: Sequence[Path]) -> Iterator[CrashReport]:
    """The reports of folders as the config reads them, whatever level it names itself."""
    reader = config.report_reader
    if "robustness_level" in type(reader).model_fields:
        reader = reader.model_copy(update={"robustness_level": "full"})
    for case in cases_in(folders):
        yield reader.read(case.source).model_copy(update={"case": case.id})


# ------------------------------------------------------------------ groundings
def first_answers(config: Config, report: CrashReport) -> tuple[dict[str, Generation], bool]:
    """What a config's model answers first, before any validator speaks.

    The answers by stage ("road", and "scenario" where the road could be drawn), and whether one is a refusal.
    """
    heard: dict[str, Generation] = {}
    context = Context.of(report)
    try:
        passages = config.retriever.retrieve(context.narrative, "road")
        network = config.road_writer.write(context, passages, (), _ask(config, "road", heard), 1)
        passages = config.retriever.retrieve(context.narrative, "scenario")
        config.scenario_writer.write(context, passages, (), _ask(config, "scenario", heard), 1, network)
    except Refused:
        return heard, True
    except InvalidOutput:  # an answer of no use has been heard all the same
        pass
    return heard, False


def _ask(config: Config, stage: str, heard: dict[str, Generation]) -> Ask:
    answer = ask_of(config)

    def ask(context: Context, query: Query) -> Generation:
        heard[stage] = answer(context, query)
        return heard[stage]

    return ask


def sample(config: Config, report: CrashReport, level: Level) -> Sample:
    """Groundings of a report's first answers at a level: road, and scenario where the road could be drawn."""
    heard, declined = first_answers(config, degrade(report, level))
    sums = {
        group.field: round(nats, 4)
        for stage, groups in GROUPS.items()
        for group in groups
        if stage in heard and (nats := nats_of(group, heard[stage].grounding)) is not None
    }
    return Sample(report.case, level, level in THIN, declined, sums)


def collected(
    config: Config, reports: Iterator[CrashReport], file: Path, jobs: int, levels: Sequence[Level] = LEVELS
) -> list[Sample]:
    """Samples of all reports at all levels; what stands in the file already is not asked again."""
    known = kept(file)
    tasks = ((report, level) for report in reports for level in levels if (report.case, level) not in known)
    with ThreadPoolExecutor(jobs) as pool, file.open("a", encoding="utf-8") as out:
        for one in pool.map(lambda task: _sampled(config, *task), tasks):
            if one is None:
                continue
            out.write(json.dumps(asdict(one)) + "\n")
            out.flush()
            known[one.case, one.level] = one
    return list(known.values())


def default_file(config: Config) -> Path:
    """Where groundings are kept: another file for another model, decoder or prompt."""
    stamp = config.backbone.stamp if config.backbone else ""
    asked = {
        kind: config.raw.get(kind) for kind in ("backbone", "decoder", "retriever", "road_writer", "scenario_writer")
    }
    prompts = [file.read_text(encoding="utf-8") for file in sorted(settings.PROMPTS.glob("*.md"))]
    digest = hashlib.sha256(json.dumps([asked, config.seed, stamp, prompts]).encode()).hexdigest()[:8]
    return Path("runs") / f"gate-{config.name}-{digest}.jsonl"


def _sampled(config: Config, report: CrashReport, level: Level) -> Sample | None:
    """A sample; None, and a line on stderr, for a report that the model cannot take."""
    try:
        return sample(config, report, level)
    except BadInput as fault:
        sys.stderr.write(f"{report.case} at {level} is left out: {fault}\n")
        return None


def kept(file: Path) -> dict[tuple[str, str], Sample]:
    """The samples of an earlier run; a line that was cut off is left out."""
    found: dict[tuple[str, str], Sample] = {}
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else ():
        try:
            one = Sample(**json.loads(line))
        except ValueError:
            continue
        found[one.case, one.level] = one
    return found


# ------------------------------------------------------------------ report
def report(samples: Sequence[Sample], precision: float | None) -> str:
    """Tables in Markdown: each group's sweep, the choice, what it is worth on reports that it was not made on."""
    fit, test = halves(samples)
    if not fit or not test or not any(s.thin for s in fit):
        raise SystemExit(f"{len(samples)} samples are too few for two halves; give more reports")
    chosen = choose(fit, NAMES, precision)
    lines = [
        f"{len({s.case for s in samples})} reports at {len({s.level for s in samples})} levels: {len(fit)} samples to "
        f"choose on, {len(test)} to measure on.",
        "",
        *(line for name in NAMES for line in _swept(fit, name)),
        "| refusals of | half | precision | recall | F1 | refused with enough evidence |",
        "|---|---|---|---|---|---|",
        *(_row(who, half, part, limits, model) for half, part in (("chosen on", fit), ("held out", test))
          for who, limits, model in (("the model", {}, True), ("the gate", chosen, False), ("both", chosen, True))),
        "",
        *_levels(test, chosen),
        "",
        "    - " + _yaml(chosen),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _swept(samples: Sequence[Sample], name: str) -> Iterator[str]:
    yield f"{name}: area under the curve {area(samples, name):.2f}"
    yield ""
    yield "| threshold, nats | precision | recall (true positive rate) | false positive rate | F1 |"
    yield "|---|---|---|---|---|"
    for threshold, s in sweep(samples, name):
        yield f"| {threshold:.2f} | {s.precision:.2f} | {s.recall:.2f} | {s.false_alarms:.2f} | {s.f1:.2f} |"
    yield ""


def _row(who: str, half: str, samples: Sequence[Sample], limits: dict[str, float | None], model: bool) -> str:
    s: Score = score(samples, refused(samples, limits, model))
    return f"| {who} | {half} | {s.precision:.2f} | {s.recall:.2f} | {s.f1:.2f} | {s.false_alarms:.2f} |"


def _levels(samples: Sequence[Sample], limits: dict[str, float | None]) -> Iterator[str]:
    yield "| level, held out | wanted | samples | refused by the model | by model or gate |"
    yield "|---|---|---|---|---|"
    for level in LEVELS:
        some = [s for s in samples if s.level == level]
        if some:
            shares = (refused(some, {}).mean(), refused(some, limits).mean())
            wanted = "refusal" if some[0].thin else "answer"
            yield f"| {level} | {wanted} | {len(some)} | {100 * shares[0]:.0f} % | {100 * shares[1]:.0f} % |"


def _yaml(limits: dict[str, float | None]) -> str:
    told = ", ".join(f"{name}: {'null' if limit is None else limit}" for name, limit in limits.items())
    return f"{{name: evidence_gate, {told}}}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Ask, sweep, choose, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", type=Path, help="folders of cases")
    parser.add_argument("--made", type=int, default=0, help="how many reports of mini's generator")
    parser.add_argument("--config", default="mini.yaml")
    parser.add_argument("--set", action="append", default=[], dest="overrides", help="key=value, as for sgcad")
    parser.add_argument("--samples", type=Path, help="kept groundings; default: a file in runs/ for config and weights")
    parser.add_argument("--precision", type=float, help="choose for recall at this precision instead of for F1")
    parser.add_argument("--jobs", type=int, default=4, help="reports asked at once")
    parser.add_argument("--limit", type=int, help="at most so many reports")
    told = parser.parse_args(arguments)
    try:
        config = load(told.config, tuple(told.overrides))
        reports = [*made(told.made), *(read(config, told.cases) if told.cases else ())][: told.limit]
        file = told.samples or default_file(config)
        file.parent.mkdir(parents=True, exist_ok=True)
        samples = collected(config, iter(reports), file, told.jobs)
    except (ConfigError, MissingTool) as fault:
        raise SystemExit(str(fault)) from fault
    sys.stdout.write(report(samples, told.precision))


if __name__ == "__main__":
    main()
