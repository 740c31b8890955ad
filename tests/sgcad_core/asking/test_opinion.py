"""A model is asked for a gist: its values, their probabilities, and what is wrong with weights."""

import json
import math

import pytest

from sgcad_core import settings
from sgcad_core.asking.opinion import load_weights, probabilities, seconded
from sgcad_core.errors import ConfigError
from sgcad_core.narrative.gist import FIELDS
from sgcad_core.records import Context, CrashReport, Generation, Query, Token

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

    told = seconded(REPORT, "mini_gist", ask)
    assert told.opinion is not None
    assert {key: one.value for key, one in told.opinion.heard.items()} == ANSWER
    assert {one.p for one in told.opinion.heard.values()} == {0.5}, "a server without probabilities"
    assert told.opinion.weights == load_weights("mini_gist")
    assert asked[0][0].narrative == REPORT.narrative
    assert list(asked[0][1].answer_schema["properties"]) == list(FIELDS)  # type: ignore[index]


def test_a_report_without_an_answer_stays_the_rules_and_says_so() -> None:
    told = seconded(REPORT, "mini_gist", lambda context, query: Generation(text="no"))
    assert told.opinion is None
    assert "no second opinion" in told.notes[-1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "its file of weights .* is missing; .*benchmarks.opinions"),
        ('{"touched": {"agree": 2}}', "is not a file of weights for the fields of a gist"),
        ("[1]", "is not a file of weights for the fields of a gist"),
        ('{"wheels": {}}', "wheels are not fields of a gist; use touched"),
    ],
)
def test_faults_of_weights_name_the_file_and_the_remedy(tmp_path, monkeypatch, text, message) -> None:
    monkeypatch.setattr(settings, "PROMPTS", tmp_path)
    if text is not None:
        (tmp_path / "kit.json").write_text(text)
    with pytest.raises(ConfigError, match=message):
        load_weights("kit")
