"""A second opinion of a crash's gist: of a model that is asked, or of the reader that learned where the rules err.

The weights of a model's answers stand beside the prompt (configs/prompts/<prompt>.json), since they are of a question
and its model. Knows no model.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence

from sgcad_core import settings
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.interfaces import Ask
from sgcad_core.narrative import learned
from sgcad_core.narrative.gist import FIELDS, Gist
from sgcad_core.opinion import Heard, Opinion, Weights
from sgcad_core.records import Context, CrashReport, Query, Token

UNKNOWN_P = 0.5
"""Of a value whose model gives no probabilities, as servers do not: the weights alone then decide."""


def seconded(report: CrashReport, prompt: str, ask: Ask) -> CrashReport:
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


def corrected(report: CrashReport) -> CrashReport:
    """The report with the learned reader's opinion; without one where it has none. Raises ConfigError: no weights."""
    said = learned.opinion(report.narrative)
    return report if said is None else report.model_copy(update={"opinion": said})


def load_weights(prompt: str) -> Mapping[str, Weights]:
    """configs/prompts/<prompt>.json: field of the gist -> its weights. Raises ConfigError with what to mend."""
    file = settings.PROMPTS / f"{prompt}.json"
    remedy = "fit them with `python -m benchmarks.opinions`"
    if not file.is_file():
        raise ConfigError(f"second_opinion {prompt!r}: its file of weights {file} is missing; {remedy}")
    try:
        found = {key: Weights(**entry) for key, entry in json.loads(file.read_text(encoding="utf-8")).items()}
    except (ValueError, AttributeError, TypeError) as fault:
        raise ConfigError(f"{file}: is not a file of weights for the fields of a gist ({fault}); {remedy}") from fault
    if strange := sorted(found.keys() - set(FIELDS)):
        raise ConfigError(f"{file}: {', '.join(strange)} are not fields of a gist; use {', '.join(FIELDS)}")
    return found


def probabilities(tokens: Sequence[Token]) -> dict[str, float]:
    """Field -> probability of its value: the product of its tokens' that were chosen; nothing without tokens."""
    text = "".join(token.text for token in tokens)
    ends, at = [], 0
    for token in tokens:
        at += len(token.text)
        ends.append(at)
    found = {}
    for key in FIELDS:
        begun = text.find(f'"{key}":')
        if begun < 0:
            continue
        begun += len(key) + 3
        over = min(at for at in (text.find(",", begun), text.find("}", begun), len(text)) if at >= 0)
        inside = [
            token for token, end in zip(tokens, ends, strict=True)
            if end > begun and end - len(token.text) < over and not token.forced
        ]  # fmt: skip
        found[key] = min(1.0, math.exp(sum(token.logp_with_context for token in inside)))
    return found
