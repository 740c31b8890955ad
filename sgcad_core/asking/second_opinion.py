"""A second opinion of a crash: a model's answers to seven questions or to the whole report, or the corrections of the
learned reader.

The weights of a model's answers stand beside the prompt (configs/prompts/<prompt>.json), since they are of a question
and its model. Knows no model.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from itertools import accumulate

from sgcad_core import settings
from sgcad_core.asking.json_field_spans import grounding
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, CrashReport, Query, Token
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.interfaces import Ask
from sgcad_core.reading.second_reader import learned_reader
from sgcad_core.reading.second_reader.combiner import FILLS
from sgcad_core.reading.second_reader.field_claims import KINDS, UNKNOWN_P
from sgcad_core.reading.second_reader.numbered import numbered_reader
from sgcad_core.reading.second_reader.seven_question_gist import FIELDS, Gist
from sgcad_core.records.second_reader import DRAWN, HEARD, LEARNED, WHOLE, Answered, Heard, Opinion, Weights
from sgcad_core.records.specs import BehaviorSpec, RoadLayout
from sgcad_core.roads.describe import road_ids
from sgcad_core.roads.layout import road_spec


def opinion_prompts(second_opinion: str) -> tuple[str, ...]:
    """Names of the prompts of a config's `second_opinion`."""
    return {"": (), LEARNED: (), WHOLE: ("mini_road", "mini_scenario")}.get(second_opinion, (second_opinion,))


def with_gist_opinion(report: CrashReport, prompt: str, ask: Ask) -> CrashReport:
    """The report with the model's opinion; without one where the model has no answer. Raises ConfigError for a prompt
    or weights that there are not."""
    weights = load_weights(prompt)
    query = Query(task=load_prompt(prompt), answer_schema=answer_schema(Gist, refusal=False), case=report.case)
    try:
        generation = ask(Context(narrative=report.narrative), query)
        gist = parse_answer(generation.text, Gist)
    except (Refused, InvalidOutput) as fault:
        return report.model_copy(update={"notes": (*report.notes, f"no second opinion: {fault}")})
    sure = probabilities(generation.tokens)
    heard = {key: Heard(value=value, p=sure.get(key, UNKNOWN_P)) for key, value in gist.model_dump().items()}
    return report.model_copy(update={"opinion": Opinion(heard=heard, weights=weights)})


def with_learned_opinion(report: CrashReport) -> CrashReport:
    """The report with the learned reader's opinion; without one where it has none. Raises ConfigError: no weights."""
    said = learned_reader.opinion(report.narrative)
    return report if said is None else report.model_copy(update={"opinion": said})


def with_model_opinion(report: CrashReport, ask: Ask) -> CrashReport:
    """The report with the learned reader's guesses and the model's answers to all of it, where it has some; without an
    opinion where no vehicle is numbered. Raises ConfigError for weights that are missing."""
    if report.reading.crash.unnumbered:
        return report
    guesses = numbered_reader.guesses(report.narrative)
    weights = load_weights(DRAWN if report.diagrams else HEARD if guesses else WHOLE, KINDS)
    learned = Opinion(weights=weights, guesses=guesses, takes=FILLS)
    context = Context(narrative=report.narrative, diagrams=report.diagrams)
    try:
        answered = _answered(context, report.case, ask)
    except (Refused, InvalidOutput) as fault:
        notes = (*report.notes, f"no second opinion: {fault}")
        return report.model_copy(update={"notes": notes, "opinion": learned})
    return report.model_copy(update={"opinion": learned.model_copy(update={"answered": answered})})


def _answered(context: Context, case: str, ask: Ask) -> Answered:
    """Both answers and the probabilities of their values. Raises Refused, InvalidOutput."""
    query = Query(task=load_prompt("mini_road"), answer_schema=answer_schema(RoadLayout), case=case)
    road = ask(context, query)
    layout = parse_answer(road.text, RoadLayout)
    ids = road_ids(road_spec(layout))
    schema = answer_schema(BehaviorSpec, enums={"road": ids, "exit_road": ids})
    task = load_prompt("mini_scenario", roads=layout.model_dump_json())
    crash = ask(context, Query(task=task, answer_schema=schema, case=case))
    behavior = parse_answer(crash.text, BehaviorSpec)
    p = {f"road.{path}": sure for path, sure in probabilities(road.tokens).items()}
    p |= {f"crash.{path}": sure for path, sure in probabilities(crash.tokens).items()}
    nats = {f"road.{path}": gain for path, gain in road.grounding.items()}
    nats |= {f"crash.{path}": gain for path, gain in crash.grounding.items()}
    told = {f"road.{path}": share for path, share in road.told.items()}
    told |= {f"crash.{path}": share for path, share in crash.told.items()}
    return Answered(layout=layout, behavior=behavior, p=p, nats=nats, told=told)


def load_weights(prompt: str, fields: Sequence[str] = FIELDS) -> Mapping[str, Weights]:
    """configs/prompts/<prompt>.json: field -> its weights. Raises ConfigError with what to mend."""
    file = settings.PROMPTS / f"{prompt}.json"
    outside = "research.benchmarks.texts.outside --drawings"
    coded = "research.benchmarks.texts.coded_fusion POOL.jsonl --answers FILE"
    pool = "research.benchmarks.texts.fuse_weights POOL.jsonl"
    remedy = f"fit them with `python -m {({WHOLE: outside, DRAWN: outside, HEARD: coded}).get(prompt, pool)} --fit ...`"
    if not file.is_file():
        raise ConfigError(f"second_opinion {prompt!r}: its file of weights {file} is missing; {remedy}")
    try:
        found = {key: Weights(**entry) for key, entry in json.loads(file.read_text(encoding="utf-8")).items()}
    except (ValueError, AttributeError, TypeError) as fault:
        raise ConfigError(f"{file}: is not a file of weights by fields ({fault}); {remedy}") from fault
    if strange := sorted(found.keys() - set(fields)):
        raise ConfigError(f"{file}: {', '.join(strange)} are not fields of it; use {', '.join(fields)}")
    return found


def probabilities(tokens: Sequence[Token]) -> dict[str, float]:
    """Path -> probability of its value: the product of those of its tokens that were chosen; nothing without tokens.

    A token belongs to the field that it overlaps, one over several to the first.
    """
    text = "".join(token.text for token in tokens)
    ends = list(accumulate(len(token.text) for token in tokens))
    chosen = [0.0 if token.forced else token.logp_with_context for token in tokens]
    nats = grounding(text, ends, chosen, [0.0] * len(tokens))
    return {path: min(1.0, math.exp(sure)) for path, sure in nats.items()}
