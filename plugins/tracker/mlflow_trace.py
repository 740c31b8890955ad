"""A case's spans as one MLflow trace of its run: finished spans, written at once. Knows `Span`; no case folder."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any

from plugins.tracker.case_spans import MODEL, Span
from plugins.tracker.mlflow_store import MAX_VALUE, Store, repository, trace_id

PREVIEW = 500
"""Characters of the narrative and of the result in the list of traces."""
FAILED = ("Failed", "failed")
"""States of steps and cases that are faults; a refusal is a result."""


def log_trace(store: Store, run: str, whole: Span, tags: Mapping[str, str], pictures: Mapping[str, Path]) -> None:
    """Logs the trace of a case's run. `pictures` by name: shown among the inputs, "picture" among the outputs."""
    from mlflow.entities import Span as Written
    from mlflow.tracing.attachments import Attachment

    kept = {name: Attachment.from_file(file) for name, file in pictures.items()}
    shown = {name: picture.ref(trace_id(run)) for name, picture in kept.items()}
    inputs = whole.inputs | {name: ref for name, ref in shown.items() if name != "picture"}
    outputs = whole.outputs | {name: ref for name, ref in shown.items() if name == "picture"}
    root = Span(whole.step, whole.kind, inputs, outputs, whole.about, children=whole.children)
    made = store.tracing.start_trace(_info(store, run, root, tags))
    store.tracing.log_spans(store.experiment_id, [Written.from_dict(span) for span in _written(root, run)])
    if kept:
        place = repository(made.tags["mlflow.artifactLocation"], store.uri)
        for picture in kept.values():
            place.upload_attachment(picture.id, picture.content_bytes)


def _info(store: Store, run: str, root: Span, tags: Mapping[str, str]) -> Any:
    from mlflow.entities import TraceInfo, TraceLocation, TraceState

    prompt, answer = root.all_tokens()
    usage = {"mlflow.trace.tokenUsage": json.dumps(_usage(prompt, answer))} if prompt or answer else {}
    step = root.step
    return TraceInfo(
        trace_id=trace_id(run),
        trace_location=TraceLocation.from_experiment_id(store.experiment_id),
        request_time=int(step.began_s * 1000),
        execution_duration=int((step.ended_s - step.began_s) * 1000),
        state=TraceState.ERROR if step.state in FAILED else TraceState.OK,
        request_preview=root.inputs["narrative"][:PREVIEW],
        response_preview=root.outputs["result"][:PREVIEW],
        trace_metadata={"mlflow.sourceRun": run, "mlflow.source.name": "sgcad", **usage},
        tags={"mlflow.traceName": step.name, **tags},
    )


def _usage(prompt: int, answer: int) -> dict[str, int]:
    return {"input_tokens": prompt, "output_tokens": answer, "total_tokens": prompt + answer}


# ------------------------------------------------------------------ spans
def _written(root: Span, run: str) -> Iterator[dict[str, Any]]:
    """All spans as MLflow's dictionaries, parents first, numbered from 1."""
    numbers, waiting = count(1), [(root, "")]
    while waiting:
        span, parent = waiting.pop(0)
        number = f"{next(numbers):016x}"
        yield _span(span, run, number, parent)
        waiting += [(child, number) for child in span.children]


def _span(span: Span, run: str, number: str, parent: str) -> dict[str, Any]:
    step = span.step
    end = int(step.ended_s * 1e9)
    failed = step.state in FAILED
    return {
        "trace_id": trace_id(run),
        "span_id": number,
        "parent_span_id": parent,
        "name": step.name,
        "start_time_unix_nano": int(step.began_s * 1e9),
        "end_time_unix_nano": end,
        "status": {"code": "ERROR" if failed else "OK", "message": step.message if failed else ""},
        "attributes": {name: json.dumps(value) for name, value in _attributes(span, run).items()},
        "events": list(_events(span.findings, end)),
    }


def _attributes(span: Span, run: str) -> dict[str, Any]:
    step = span.step
    found = {"mlflow.traceRequestId": trace_id(run), "mlflow.spanType": span.kind, "state": step.state, **span.about}
    found |= {"message": step.message} if step.message else {}
    found |= {"mlflow.spanInputs": span.inputs} if span.inputs is not None else {}
    found |= {"mlflow.spanOutputs": span.outputs} if span.outputs is not None else {}
    if span.tokens:
        found["mlflow.chat.tokenUsage"] = _usage(*span.tokens)
    if span.kind == MODEL:
        found |= {"mlflow.llm.model": step.name, "mlflow.message.format": "openai"}
    return found


def _events(findings: Sequence[Mapping[str, Any]], at_ns: int) -> Iterator[dict[str, Any]]:
    """Findings as events, named by who found them and how grave they are."""
    for found in findings:
        told = {name: str(value)[:MAX_VALUE] for name, value in found.items() if value not in (None, "", [], {})}
        name = f"{found.get('severity', 'finding')}: {found.get('source', '')}"
        yield {"name": name, "time_unix_nano": at_ns, "attributes": told}
