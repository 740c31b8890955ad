"""The refinement loop: what is asked again, what ends it, what is kept."""

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from sgcad_core.asking.refine import DOUBTFUL_ATTEMPTS, MAX_ATTEMPTS, Refinement, Turn, _holds, refine
from sgcad_core.case.records import (
    Attempt,
    Context,
    CrashReport,
    Evidence,
    Finding,
    Generation,
    Hold,
    Query,
    RoadNetwork,
)
from sgcad_core.errors import InvalidOutput, MissingTool, Refused
from sgcad_core.findings import Told
from sgcad_core.interfaces import Validator

CONTEXT = Context(narrative="V1 struck V2.")
REPORT = CrashReport(case="c", narrative="V1 struck V2.")


class Judge(Validator):
    """Finds what the network's log names, one finding a word: "repair", "refuse" or "note"."""

    stage = "road"

    def findings(self, artifact, evidence):
        words = artifact.log.split()
        told = Told(field="lanes", value=2, by="rules", confidence=0.9, start=0, end=4, sentence="Two lanes.")
        return [
            Finding(
                source="judge",
                severity=word,
                what=f"a {word}",
                value="lanes",
                told=told if word == "question" else None,
            )
            for word in words
        ]


class Toolless(Validator):
    """Lacks its tool."""

    stage = "road"

    def findings(self, artifact, evidence):
        raise MissingTool("no schema checker: pip install lxml")


def evidence(generation):
    return Evidence(report=REPORT, generation=generation)


def answer(context, query):
    return Generation(text=f"answer {query.attempt}")


def by_log(*logs):
    """A writer that asks once an attempt and writes networks with these logs in turn."""

    def write(findings, ask, attempt):
        ask(CONTEXT, Query(task="draw"))
        return RoadNetwork(log=logs[min(attempt, len(logs)) - 1])

    return write


def test_a_good_first_answer_is_written_after_one_attempt():
    outcome = refine("road", by_log(""), [Judge()], evidence, ask=answer)
    assert (outcome.status, len(outcome.attempts)) == ("written", 1)
    assert outcome.artifact == RoadNetwork(log="")


def test_findings_go_back_to_the_writer():
    outcome = refine("road", by_log("repair", ""), [Judge()], evidence, ask=answer)
    assert outcome.status == "written"
    assert [a.number for a in outcome.attempts] == [1, 2]
    assert outcome.attempts[0].prompt.endswith("stand here]")
    assert "Your previous answer was:\nanswer 1\n" in outcome.attempts[1].prompt
    assert "1. [judge] a repair (found lanes)" in outcome.attempts[1].prompt
    assert outcome.attempts[1].answer == "answer 2"


def test_findings_can_be_kept_from_a_model_that_cannot_read_them():
    outcome, _ = Refinement("road", by_log("repair", ""), [Judge()], evidence, answer, show_findings=False).run()
    assert outcome.attempts[0].prompt == outcome.attempts[1].prompt


def test_notes_are_kept_and_do_not_ask_again():
    outcome = refine("road", by_log("note note"), [Judge()], evidence, ask=answer)
    assert outcome.status == "written"
    assert [f.severity for f in outcome.attempts[0].findings] == ["note", "note"]


def test_a_refusing_finding_ends_the_stage_with_the_missing_evidence():
    outcome = refine("road", by_log("repair", "repair refuse"), [Judge()], evidence, ask=answer)
    assert (outcome.status, outcome.reason, outcome.missing) == ("refused", "a refuse", ("lanes",))
    assert len(outcome.attempts) == 2
    assert outcome.artifact is None


def test_a_refusing_writer_is_never_asked_again():
    def write(findings, ask, attempt):
        raise Refused("the diagram contradicts the text", ["the road of V2"])

    outcome = refine("road", write, [Judge()], evidence, ask=answer)
    assert (outcome.status, outcome.missing, len(outcome.attempts)) == ("refused", ("the road of V2",), 1)
    assert outcome.attempts[0].findings[0].severity == "refuse"


def test_validators_after_a_refusal_are_not_asked():
    outcome = refine("road", by_log("refuse"), [Judge(), Toolless()], evidence, ask=answer)
    assert outcome.status == "refused"


def test_a_missing_tool_is_not_an_answer_to_repair():
    with pytest.raises(MissingTool, match="pip install lxml"):
        refine("road", by_log(""), [Toolless()], evidence, ask=answer)


def test_ten_attempts_exhaust_a_stage_and_the_best_is_remembered():
    outcome = refine("road", by_log("repair repair", "repair", "repair repair"), [Judge()], evidence, ask=answer)
    assert (outcome.status, len(outcome.attempts)) == ("exhausted", MAX_ATTEMPTS)
    assert outcome.artifact == RoadNetwork(log="repair")
    assert "nearest was attempt 2: [judge] a repair" in outcome.reason


def test_unusable_answers_exhaust_a_stage_without_artifact():
    def write(findings, ask, attempt):
        raise InvalidOutput("no JSON", [])

    outcome = refine("road", write, [Judge()], evidence, ask=answer, max_attempts=3)
    assert (outcome.status, outcome.artifact, len(outcome.attempts)) == ("exhausted", None, 3)
    assert outcome.attempts[0].findings[0].what == "no JSON"


def test_a_note_alone_does_not_make_an_unusable_answer_usable():
    def write(findings, ask, attempt):
        raise InvalidOutput("no JSON", [Finding(source="reader", severity="note", what="cut off")])

    outcome = refine("road", write, [], evidence, ask=answer, max_attempts=2)
    assert outcome.status == "exhausted"
    assert outcome.reason.endswith("[road] no JSON")


def test_a_writer_without_a_model_gets_one_attempt():
    def write(findings, ask, attempt):
        return RoadNetwork(log="repair")

    outcome = refine("road", write, [Judge()], evidence)
    assert (outcome.status, len(outcome.attempts)) == ("exhausted", 1)
    assert outcome.artifact == RoadNetwork(log="repair")


def test_a_writer_that_is_declared_to_need_no_model_cannot_ask_one():
    with pytest.raises(TypeError, match="set asks_model = True"):
        refine("road", by_log(""), [], evidence)


def test_validators_see_the_generation_of_this_attempt():
    seen = []

    def keep(generation):
        seen.append(generation.text)
        return evidence(generation)

    refine("road", by_log("repair", ""), [Judge()], keep, ask=answer)
    assert seen == ["answer 1", "answer 2"]


def test_queries_are_labeled_with_stage_and_attempt_and_all_calls_are_kept():
    stage = Refinement("road", by_log("repair", ""), [Judge()], evidence, ask=answer)
    _, calls = stage.run()
    assert [(c.query.stage, c.query.attempt, c.generation.text) for c in calls] == [
        ("road", 1, "answer 1"),
        ("road", 2, "answer 2"),
    ]


def test_the_prompt_of_a_call_that_gave_nothing_is_kept():
    def fail(context, query):
        raise InvalidOutput("the model wrote forever")

    outcome = refine("road", by_log(""), [Judge()], evidence, ask=fail, max_attempts=1)
    assert outcome.attempts[0].prompt.startswith("draw")
    assert outcome.attempts[0].answer == ""


def test_a_stage_goes_on_turn_by_turn_as_at_once():
    """A flow makes a task of each turn."""
    stage = Refinement("road", by_log("repair", "repair", ""), [Judge()], evidence, answer)
    turns = []
    while not stage.ended(turns):
        turns.append(stage.next_turn(turns))
    at_once = Refinement("road", by_log("repair", "repair", ""), [Judge()], evidence, answer).turns()
    assert [turn.attempt.number for turn in turns] == [1, 2, 3]
    assert [(t.attempt.prompt, t.attempt.findings) for t in turns] == [
        (t.attempt.prompt, t.attempt.findings) for t in at_once
    ]


def test_a_question_is_asked_once_and_the_answer_with_the_fewest_is_kept():
    logs = "question question", "question", ""
    outcome = refine("road", by_log(*logs), [Judge()], evidence, ask=answer)
    assert (outcome.status, len(outcome.attempts), outcome.kept) == ("written", 2, 2)
    assert outcome.artifact == RoadNetwork(log="question")
    assert outcome.told_by is outcome.attempts[1]
    assert "1. This sentence may tell lanes = 2: 'Two lanes.' (a question)." in outcome.attempts[1].prompt


def test_a_doubt_is_not_put_to_a_model():
    outcome = refine("road", by_log("doubt", ""), [Judge()], evidence, ask=answer)
    assert (outcome.status, len(outcome.attempts), outcome.kept) == ("written", 1, 1)
    outcome = refine("road", by_log("repair doubt", ""), [Judge()], evidence, ask=answer)
    assert "a doubt" not in outcome.attempts[1].prompt


def test_an_attempt_hears_of_every_former_one():
    outcome = refine("road", by_log("repair", "repair repair", ""), [Judge()], evidence, ask=answer)
    assert "- attempt 1, answer = lanes: [judge] a repair" in outcome.attempts[2].prompt


def test_a_model_that_cannot_read_questions_draws_anew_a_few_times():
    outcome, _ = Refinement("road", by_log("question"), [Judge()], evidence, answer, show_findings=False).run()
    assert (outcome.status, len(outcome.attempts), outcome.kept) == ("written", DOUBTFUL_ATTEMPTS, 1)


@pytest.mark.parametrize(("logs", "status", "attempts", "kept"), [
    (("repair", ""), "written", 2, 2), (("repair", "repair"), "exhausted", 2, 1), (("question", ""), "written", 2, 2),
    (("question", "question"), "written", 2, 1), (("doubt", ""), "written", 1, 1),
    (("repair", "question"), "written", 2, 2),
])  # fmt: skip
def test_a_writer_that_mends_gets_a_second_attempt(logs, status, attempts, kept):
    def write(findings, ask, attempt):
        assert bool(findings) == (attempt > 1)
        return RoadNetwork(log=logs[attempt - 1])

    outcome, _ = Refinement("road", write, [Judge()], evidence, mends=("repair", "question")).run()
    assert (outcome.status, len(outcome.attempts), outcome.kept) == (status, attempts, kept)


@pytest.mark.parametrize(("logs", "attempts", "kept"), [
    (("question", ""), 2, 2), (("repair", "question", "repair", "repair", ""), 4, 2), (("question", "refuse"), 2, 1),
    (("question", "repair", "question question", ""), 3, 1),
])  # fmt: skip
def test_a_questioned_artifact_stands_where_nothing_better_comes(logs, attempts, kept):
    outcome = refine("road", by_log(*logs), [Judge()], evidence, ask=answer)
    assert (outcome.status, len(outcome.attempts), outcome.kept) == ("written", attempts, kept)


def test_nobody_asks_again_for_a_doubt_that_the_next_attempt_would_not_hear_of():
    outcome, _ = Refinement("road", by_log("doubt", ""), [Judge()], evidence, answer, show_findings=False).run()
    assert (outcome.status, len(outcome.attempts)) == ("written", 1)


def test_a_doubt_about_what_is_to_be_repaired_holds_nothing():
    def turn(*severities):
        holds = (Hold(items="actors", at=1, either=({"id": ("V1",)},)),)
        findings = tuple(Finding(source="judge", severity=s, what=s, holds=holds) for s in severities)
        return Turn(Attempt(stage="scenario", number=1, findings=findings), RoadNetwork())

    assert len(_holds([turn("doubt")])) == 1
    doubted = turn("doubt").attempt.findings
    repaired = turn("repair").attempt.findings[0].model_copy(update={"holds": ()})
    assert _holds([Turn(Attempt(stage="scenario", number=1, findings=(*doubted, repaired)), RoadNetwork())]) == ()


WORDS = st.lists(st.sampled_from(["repair", "note", "refuse", "question", "doubt"]), max_size=4)


@given(st.lists(WORDS, min_size=1, max_size=12), st.integers(1, 10))
@hypothesis_settings(max_examples=60, deadline=None)
def test_the_loop_always_ends_in_one_of_three_ways(words, limit):
    outcome = refine("road", by_log(*map(" ".join, words)), [Judge()], evidence, ask=answer, max_attempts=limit)
    every = [[f.severity for f in a.findings] for a in outcome.attempts]
    usable = [i for i, found in enumerate(every, 1) if not {"repair", "refuse"} & set(found)]
    last = every[-1]
    assert 1 <= len(outcome.attempts) <= limit
    assert [a.number for a in outcome.attempts] == list(range(1, len(outcome.attempts) + 1))
    expected = "written" if usable else "refused" if "refuse" in last else "exhausted"
    assert outcome.status == expected
    assert all({"repair", "question"} & set(found) for found in every[:-1])
    if usable:
        soft = {i: (every[i - 1].count("question"), every[i - 1].count("doubt")) for i in usable}
        assert outcome.kept == min(usable, key=soft.__getitem__)
        assert len(every) < usable[0] + DOUBTFUL_ATTEMPTS


class Exact(Validator):
    """Knows which road the answer has to name."""

    stage = "road"

    def findings(self, artifact, evidence):
        hold = Hold(items="legs", key="bearing", values=("N",), either=({"lanes_in": (2,)},))
        return [Finding(source="exact", what="lanes", holds=(hold,))] if artifact.log != "2" else []


def held_run(hold_findings):
    """A model that says 1 until its schema leaves 2 only."""
    leg = {"bearing": {"enum": ["N", "S"]}, "lanes_in": {"type": "integer", "minimum": 0, "maximum": 8}}
    items = {"type": "object", "properties": leg}
    schema = {"type": "object", "properties": {"legs": {"type": "array", "items": items, "maxItems": 8}}}

    def say(context, query):
        first = query.answer_schema["properties"]["legs"]["items"]
        lanes = first.get("anyOf", [first])[0]["properties"]["lanes_in"]
        return Generation(text=str(lanes.get("enum", [1])[0]))

    def write(findings, ask, attempt):
        return RoadNetwork(log=ask(CONTEXT, Query(task="draw", answer_schema=schema)).text)

    return Refinement(
        "road", write, [Exact()], evidence, say, max_attempts=3, show_findings=False, hold_findings=hold_findings
    ).run()[0]


def test_exact_findings_narrow_the_next_answer():
    outcome = held_run(hold_findings=True)
    assert (outcome.status, len(outcome.attempts)) == ("written", 2)
    assert [len(attempt.held) for attempt in outcome.attempts] == [0, 1]
    assert outcome.attempts[1].held[0].line() == "legs with bearing N: lanes_in 2"


def test_findings_are_not_held_unless_asked():
    outcome = held_run(hold_findings=False)
    assert (outcome.status, len(outcome.attempts)) == ("exhausted", 3)
    assert not any(attempt.held for attempt in outcome.attempts)


def test_the_newest_findings_hold_before_older_ones():
    def turn(number):
        hold = Hold(items="actors", at=1, either=({"id": (f"V{number}",)},))
        finding = Finding(source="exact", what="an actor", holds=(hold,))
        return Turn(Attempt(stage="scenario", number=number, findings=(finding,)), None)

    assert [hold.either[0]["id"] for hold in _holds([turn(1), turn(2), turn(1)])] == [("V1",), ("V2",)]
