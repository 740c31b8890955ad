"""One trace a case: stages, attempts and model answers with their real times, findings and tokens, of its run."""

import json

import pytest

from plugins.tracker.case_spans import spans_of
from tests.plugins.tracker.mlflow_cases import REFUSED, RESULT, log, runs_of

STEPS = [
    {"name": "read", "began_s": 100.0, "ended_s": 101.0, "state": "Completed", "message": ""},
    {"name": "retrieve[road]", "began_s": 101.0, "ended_s": 101.5, "state": "Completed", "message": ""},
    {"name": "road[1]", "began_s": 102.0, "ended_s": 105.0, "state": "Repair", "message": "two legs"},
    {"name": "road[2]", "began_s": 105.0, "ended_s": 107.0, "state": "Accepted", "message": ""},
    {"name": "simulate", "began_s": 108.0, "ended_s": 109.0, "state": "Failed", "message": "SIGSEGV"},
]
GENERATION = {
    "finish": "stop", "prompt_tokens": 11, "answer_tokens": 3, "model_calls": 2, "seconds": 1.5,
    "grounding": {"$.legs": 0.75},
}  # fmt: skip
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def case_dir(out):
    """A case of two attempts, of which a model answered the second."""
    folder = out / "kit" / "c9"
    for number, severity in ((1, "repair"), (2, "note")):
        place = folder / "attempts" / f"road-{number:02d}"
        place.mkdir(parents=True, exist_ok=True)
        (place / "prompt.txt").write_text(f"ask {number}")
        (place / "answer.txt").write_text(f"answer {number}")
        found = {"source": "topology", "severity": severity, "what": "two legs", "where": "$.legs"}
        (place / "findings.json").write_text(json.dumps([found]))
        about = {"stage": "road", "number": number, "seconds": 0.5 * number}
        (place / "attempt.json").write_text(json.dumps(about | ({"generation": GENERATION} if number == 2 else {})))
    (folder / "report.txt").write_text("V1 hit V2.")
    (folder / "diagram.png").write_bytes(PNG)
    (folder / "metrics.json").write_text(json.dumps({"exact": {"collision": True}, "thresholds": {"theta": 1}}))
    (folder / "steps.json").write_text(json.dumps(STEPS))
    yield folder
    (folder / "steps.json").unlink(missing_ok=True)


def trace_of(made, case):
    client, _, children = runs_of(made)
    run = children[case]
    (trace,) = client.search_traces(locations=[run.info.experiment_id], filter_string=f"run_id = '{run.info.run_id}'")
    return client, run, trace


def tree(trace):
    """Name of the parent of every span, by name."""
    spans = {span.span_id: span for span in trace.data.spans}
    return {span.name: spans[span.parent_id].name if span.parent_id else "" for span in trace.data.spans}


def test_a_case_is_a_trace_of_its_stages_attempts_and_model_answers(tracker, out, case_dir):
    made = tracker()
    made.log_case("kit", {"backbone": {"name": "openai", "model": "gpt"}}, case_dir, RESULT)
    _, run, trace = trace_of(made, "c9")
    assert tree(trace) == {
        "c9": "", "read": "c9", "retrieve[road]": "c9", "road": "c9", "simulate": "c9", "road[1]": "road",
        "road[2]": "road", "gpt": "road[2]",
    }  # fmt: skip
    spans = {span.name: span for span in trace.data.spans}
    assert {name: (span.start_time_ns / 1e9, span.end_time_ns / 1e9) for name, span in spans.items()} == {
        "c9": (100, 109), "read": (100, 101), "retrieve[road]": (101, 101.5), "road": (102, 107),
        "simulate": (108, 109), "road[1]": (102, 105), "road[2]": (105, 107), "gpt": (105, 106.5),
    }  # fmt: skip
    assert spans["simulate"].status.status_code == "ERROR"
    assert spans["road[1]"].inputs == {"prompt": "ask 1"}
    assert spans["gpt"].inputs == {"messages": [{"role": "user", "content": "ask 2"}]}
    assert spans["gpt"].outputs["choices"][0]["message"]["content"] == "answer 2"
    assert spans["gpt"].span_type == "CHAT_MODEL"
    assert spans["gpt"].attributes["grounding"] == {"$.legs": 0.75}
    (event,) = spans["road[1]"].events
    assert (event.name, event.attributes["where"]) == ("repair: topology", "$.legs")
    assert (run.info.start_time, run.info.end_time) == (100_000, 109_000)


def test_a_trace_has_the_narrative_the_drawing_the_end_in_words_and_the_sum_of_tokens(tracker, out, case_dir):
    made = tracker()
    log(made, out, "c9")
    _, run, trace = trace_of(made, "c9")
    root = next(span for span in trace.data.spans if span.parent_id is None)
    assert root.inputs["narrative"] == "V1 hit V2."
    assert root.outputs["result"] == trace.info.response_preview == "generated: no contact"
    assert trace.info.token_usage == {"input_tokens": 11, "output_tokens": 3, "total_tokens": 14}
    assert trace.info.trace_metadata["mlflow.sourceRun"] == run.info.run_id
    assert {trace.info.tags[name] for name in ("sgcad.status", "sgcad.account")} == {"generated", "none"}
    picture = root.inputs["diagram"].removeprefix("mlflow-attachment://").partition("?")[0]
    place = made._store(out).file.parent / "mlflow-artifacts"
    (kept,) = place.rglob(f"attachments/{picture}")
    assert kept.read_bytes() == PNG


def test_a_case_done_again_has_one_trace(tracker, out, case_dir):
    made = tracker()
    log(made, out, "c9")
    log(made, out, "c9", REFUSED)
    client, run, trace = trace_of(made, "c9")
    assert trace.info.tags["sgcad.status"] == "refused"
    assert len(client.search_traces(locations=[run.info.experiment_id])) == 1


def test_a_folder_without_steps_has_them_from_its_durations(case_dir):
    (case_dir / "steps.json").unlink()
    (case_dir / "result.json").write_text("{}")
    ended = (case_dir / "result.json").stat().st_mtime
    whole = spans_of(case_dir, RESULT)
    assert [child.step.name for child in whole.children] == ["read", "road"]
    (road,) = [child for child in whole.children if child.step.name == "road"]
    assert [(child.step.name, child.step.state) for child in road.children] == [
        ("road[1]", "Repair"), ("road[2]", "Accepted")
    ]  # fmt: skip
    assert whole.step.ended_s == pytest.approx(ended)
    assert whole.step.began_s == pytest.approx(ended - 0.1 - 1.5)
    (case_dir / "result.json").unlink()


def test_a_case_that_failed_before_its_first_step_is_a_span_alone(tmp_path):
    whole = spans_of(tmp_path, {"status": "failed", "reason": "no such report"})
    assert (whole.step.name, whole.step.state, whole.children) == (tmp_path.name, "failed", ())
    assert whole.outputs == {"result": "failed: no such report"}
