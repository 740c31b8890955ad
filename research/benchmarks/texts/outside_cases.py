"""Reports of other writers (`research/benchmarks/texts/outside`): what each tells, how the rules read it, what a model
answers.

Half of them, by the hash of the id, may be looked at; of the blind half only totals are.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from flows.case.steps import ask_of
from research.benchmarks.texts import answer_cache
from research.generator.report import Report
from research.generator.writer_texts import Written, report_of
from research.renderer.draw import draw_report
from research.rows.coded_incidents import by_hash
from sgcad_core.asking.second_opinion import with_model_opinion
from sgcad_core.case.records import CrashReport, Diagram
from sgcad_core.config import load as load_config
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.second_reader.answered_values import model_claims
from sgcad_core.reading.second_reader.field_claims import Claims, rules_claim
from sgcad_core.reading.text.compass import COMPASS
from sgcad_core.records.second_reader import Answered
from sgcad_core.records.specs import BehaviorSpec, RoadLayout

DRAWN = "+drawing"
"""Behind the id of a report that is read with a drawing of its crash."""
AT_ONCE = 8
_FACTS = {"maneuver": "man", "contact": "contact.0", "areas": "areas.0"}
"""Kinds of fields whose facts the generator calls otherwise."""


@dataclass(frozen=True)
class Case:
    """One text: what it tells, how the rules read it, what the model answers (None: nothing)."""

    id: str
    truth: Claims
    reading: Reading
    answered: Answered | None

    @cached_property
    def claims(self) -> tuple[Claims, Claims]:
        """Those of the rules and of the model."""
        return rules_claim(self.reading), model_claims(self.answered) if self.answered else {}

    @property
    def blind(self) -> bool:
        """Whether only totals of it are looked at; with a drawing as without."""
        return by_hash(self.id.removesuffix(DRAWN)) % 2 == 1


# ------------------------------------------------------------------ cases
def with_drawing(one: Written) -> Written:
    """The same report, to be read with a drawing."""
    return replace(one, id=one.id + DRAWN)


def evidence_of(one: Written) -> CrashReport:
    """The text, with a drawing of its crash where its id asks for one; the drawing follows from the id."""
    if not one.id.endswith(DRAWN):
        return CrashReport(case=one.id, narrative=one.text)
    drawn = draw_report(report_of(one, by_hash(one.id), image=True))
    png = io.BytesIO()
    drawn.save(png, "PNG")
    diagram = Diagram(png=png.getvalue(), width_px=drawn.width, height_px=drawn.height)
    return CrashReport(case=one.id, narrative=one.text, diagrams=(diagram,))


def truth_of(one: Written) -> Claims:
    """What the text tells, or its drawing, of all that the crash has."""
    report = report_of(one, 0, image=one.id.endswith(DRAWN))
    answered = Answered(layout=RoadLayout(**report.road), behavior=BehaviorSpec(**(report.behavior or {})))
    return {key: claim for key, claim in model_claims(answered).items() if _told(key, report)}


def _told(key: str, report: Report) -> bool:
    kind, _, of = key.partition(".")
    told = report.stated | report.drawn
    if kind in ("contact", "areas", "legs", "curve", "control", "light", "weather", "surface"):
        return _FACTS.get(kind, kind) in told
    if of in COMPASS:
        axis = str(COMPASS.index(of) % 4)
        turning = any(leg.turns_in for leg in report.crash.legs if leg.bearing % 4 == int(axis))
        needed = {f"{kind}.{axis}"} | ({f"turns.{axis}"} if kind == "lanes" and turning else set())
        return needed <= told
    return f"{_FACTS.get(kind, kind)}.{of}" in told


def cases(texts: Sequence[Written], answers: Mapping[str, Answered | None]) -> list[Case]:
    """Texts with both readers' claims."""
    return [Case(one.id, truth_of(one), read(one.text), answers.get(one.id)) for one in texts]


def asked(
    texts: Sequence[Written], config: str, overrides: Sequence[str], file: Path | None
) -> dict[str, Answered | None]:
    """The model's answers by id; those in the file are not asked for again."""
    ask = ask_of(load_config(config, tuple(overrides)))

    def answer(one: Written) -> Any:
        opinion = with_model_opinion(evidence_of(one), ask).opinion
        return opinion.answered.model_dump(mode="json") if opinion and opinion.answered else None

    known = answer_cache.answers({one.id: one for one in texts}, answer, "answered", file, AT_ONCE)
    return {id: Answered(**found) if found else None for id, found in known.items()}
