"""A model is asked for a gist: its values, their probabilities, and what is wrong with weights."""

import json
import math

import pytest

from sgcad_core import settings
from sgcad_core.asking.second_opinion import load_weights, probabilities, with_gist_opinion, with_model_opinion
from sgcad_core.case.records import Context, CrashReport, Diagram, Generation, Query, Token
from sgcad_core.errors import ConfigError
from sgcad_core.reading.second_reader.field_claims import KINDS
from sgcad_core.reading.second_reader.numbered.fuse_numbered import RULE as LEARNED_RULE
from sgcad_core.reading.second_reader.seven_question_gist import FIELDS
from sgcad_core.records.second_reader import DRAWN, HEARD, WHOLE

ANSWER = {
    "touched": True, "met": "suv", "subject": "stopped", "other": "straight", "subject_area": "back",
    "other_area": "front", "junction": False,
}  # fmt: skip
REPORT = CrashReport(case="a", narrative="The AV was stopped when an SUV struck its rear.")


def token(text: str, p: float = 1.0, forced: bool = True) -> Token:
    return Token(text=text, logp_with_context=math.log(p), forced=forced)


def test_a_probability_is_that_of_the_chosen_tokens_of_a_value() -> None:
    tokens = [
        token('{"touched":', 0.1), token("true", 0.9, forced=False), token(',"met":"', 0.2),
        token("s", 0.5, forced=False), token("uv", 0.5, forced=False), token('","subject":', 0.1),
    ]  # fmt: skip
    found = probabilities(tokens)
    assert found["touched"] == pytest.approx(0.9)
    assert found["met"] == pytest.approx(0.25)
    assert "junction" not in found


def test_an_answer_becomes_an_opinion_of_the_report_with_the_weights_of_its_prompt() -> None:
    asked: list[tuple[Context, Query]] = []

    def ask(context: Context, query: Query) -> Generation:
        asked.append((context, query))
        return Generation(text=json.dumps(ANSWER))

    told = with_gist_opinion(REPORT, "mini_gist", ask)
    assert told.opinion is not None
    assert {key: one.value for key, one in told.opinion.heard.items()} == ANSWER
    assert {one.p for one in told.opinion.heard.values()} == {0.5}, "a server without probabilities"
    assert told.opinion.weights == load_weights("mini_gist")
    assert asked[0][0].narrative == REPORT.narrative
    assert list(asked[0][1].answer_schema["properties"]) == list(FIELDS)  # type: ignore[index]


def test_a_report_without_an_answer_stays_the_rules_and_says_so() -> None:
    told = with_gist_opinion(REPORT, "mini_gist", lambda context, query: Generation(text="no"))
    assert told.opinion is None
    assert "no second opinion" in told.notes[-1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "its file of weights .* is missing; .*research.benchmarks.texts.fuse_weights"),
        ('{"touched": {"agree": 2}}', "is not a file of weights by fields"),
        ("[1]", "is not a file of weights by fields"),
        ('{"wheels": {}}', "wheels are not fields of it; use touched"),
    ],
)
def test_faults_of_weights_name_the_file_and_the_remedy(tmp_path, monkeypatch, text, message) -> None:
    monkeypatch.setattr(settings, "PROMPTS", tmp_path)
    if text is not None:
        (tmp_path / "kit.json").write_text(text)
    with pytest.raises(ConfigError, match=message):
        load_weights("kit")


# ------------------------------------------------------------------ the whole report
LEG = {
    "lanes_in": 1, "lanes_out": 1, "turns_in": [], "center_turn_lane": False, "median": "none", "kind": "road",
    "control": "none", "curve": "none", "speed_limit_mph": None,
}  # fmt: skip
ROAD = json.dumps({"legs": [{"bearing": b} | LEG for b in "NS"], "accesses": []})
ACTOR = {
    "kind": "car", "direction": "forward", "lane": None, "exit_road": None, "maneuver": "straight", "speed_mph": None,
    "length_m": None, "width_m": None,
}  # fmt: skip
CONTACT = {"striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "front"}
CRASH = json.dumps({
    "actors": [{"id": "V1", "road": "S"} | ACTOR, {"id": "V2", "road": "N"} | ACTOR],
    "contacts": [CONTACT], "light": None, "weather": None, "surface": None,
})  # fmt: skip
NUMBERED = CrashReport(
    case="b", narrative="V1 was northbound. V2 was southbound. V1 struck V2.",
    diagrams=(Diagram(png=b"", width_px=1, height_px=1),),
)  # fmt: skip

CHOSEN = ("road.legs[0].bearing", "crash.actors[0].road")


def tokens(text: str, at: str, p: float) -> tuple[Token, ...]:
    """An answer of which one value was chosen."""
    before, _, behind = text.partition(at)
    return token(before), token(at, p, forced=False), token(behind)


def test_the_whole_report_is_asked_in_two_questions_with_its_drawing() -> None:
    asked: list[tuple[Context, Query]] = []

    def ask(context: Context, query: Query) -> Generation:
        asked.append((context, query))
        text, at = (ROAD, '"N"') if len(asked) == 1 else (CRASH, '"S"')
        return Generation(text=text, tokens=tokens(text, at, 0.75))

    told = with_model_opinion(NUMBERED, ask)
    assert told.opinion is not None
    assert told.opinion.answered is not None
    answered = told.opinion.answered
    assert [leg.bearing for leg in answered.layout.legs] == ["N", "S"]
    assert answered.behavior.contacts[0].struck == "V2"
    assert answered.p["road.legs[0].bearing"] == pytest.approx(0.75)
    assert answered.p["crash.actors[0].road"] == pytest.approx(0.75)
    assert min(sure for path, sure in answered.p.items() if path not in CHOSEN) == 1.0, "forced"
    assert told.opinion.weights == load_weights(DRAWN, KINDS)
    (first, road), (second, crash) = asked
    assert first.diagrams == second.diagrams == NUMBERED.diagrams
    assert '"bearing":"N"' in crash.task
    assert '"bearing"' not in road.task


def test_of_a_report_that_numbers_nobody_nothing_is_asked() -> None:
    def ask(context: Context, query: Query) -> Generation:
        raise AssertionError("asked")

    assert with_model_opinion(REPORT, ask) is REPORT


@pytest.mark.parametrize("answers", [["no"], [ROAD, "no"], ['{"refuse": "too thin", "missing": []}']])
def test_without_an_answer_the_rules_stand_and_the_notes_say_so(answers: list[str]) -> None:
    some = iter(answers)
    told = with_model_opinion(NUMBERED, lambda context, query: Generation(text=next(some)))
    assert told.opinion is not None
    assert told.opinion.answered is None
    assert all(fact.rule == LEARNED_RULE for fact in told.reading.facts if fact.basis == "model")
    assert "no second opinion" in told.notes[-1]


def test_the_shipped_weights_are_of_kinds_of_fields() -> None:
    assert all(set(load_weights(name, KINDS)) == set(KINDS) for name in (WHOLE, DRAWN, HEARD))
