"""What a config's model answers first, before any validator speaks: one road answer, one scenario answer."""

from __future__ import annotations

from flows.case.chain import ask_of
from sgcad_core.case.records import Context, CrashReport, Generation, Query
from sgcad_core.config import Config
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.interfaces import Ask


def first_answers(config: Config, report: CrashReport) -> tuple[dict[str, Generation], bool]:
    """The answers by stage ("road", and "scenario" where the road could be drawn), and whether one is a refusal."""
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
