"""What a config's model answers first, before any validator speaks: one road answer, one scenario answer."""

from __future__ import annotations

import io
from collections.abc import Callable

from mini.feed import drawing
from mini.generator.report import Report
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.records import Context, CrashReport, Diagram, Generation, Query


def first_answers(config: Config, report: CrashReport) -> tuple[dict[str, Generation], bool]:
    """The answers by stage ("road", and "scenario" where the road could be drawn), and whether one is a refusal."""
    heard: dict[str, Generation] = {}
    context = Context(narrative=report.narrative, diagrams=report.diagrams)
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


def _ask(config: Config, stage: str, heard: dict[str, Generation]) -> Callable[[Context, Query], Generation]:
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:
        raise ConfigError(f"{config.name}: no backbone or no decoder, so there is no model to ask; use mini.yaml")

    def ask(context: Context, query: Query) -> Generation:
        heard[stage] = backbone.generate(context, query, decoder.at(1), seed=config.seed)
        return heard[stage]

    return ask


def as_report(report: Report) -> CrashReport:
    """A made report as readers give one, with its drawing if it has one."""
    picture = drawing(report)
    diagrams: tuple[Diagram, ...] = ()
    if picture is not None:
        out = io.BytesIO()
        picture.save(out, "PNG")
        diagrams = (Diagram(png=out.getvalue(), width_px=picture.width, height_px=picture.height),)
    return CrashReport(case=f"made-{report.seed}", narrative=report.narrative, diagrams=diagrams)
