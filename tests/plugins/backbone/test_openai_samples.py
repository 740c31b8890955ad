"""Contrast of whole answers, against a real local HTTP server with a small language model of its own.

Its model: one token a letter; after a prompt that tells a left turn "left" is likelier than without one.
"""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Iterator, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plugins.backbone.openai_samples import OpenAISamples, Sample
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.vcd import Vcd
from sgcad_core.case.records import Context, Query
from sgcad_core.errors import ConfigError, InvalidOutput
from tests.plugins.backbone.folders import diagram

WITH = {"straight": math.log(0.5), "left": math.log(0.4), "right": math.log(0.1)}
WITHOUT = {"straight": math.log(0.8), "left": math.log(0.1), "right": math.log(0.1)}
CONTEXT, QUERY = Context(narrative="V1 turned left."), Query(task="What did V1 do?")


class Service(ThreadingHTTPServer):
    """Text completions; `lacks`: what it does not tell or do."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.lacks = ""
        self.seen: list[dict[str, Any]] = []


class Handler(BaseHTTPRequestHandler):
    server: Service

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.seen.append(body)
        status = 400 if self.server.lacks == "echo refused" and body.get("echo") else 200
        data = json.dumps({"choices": self.choices(body)} if status == 200 else {"error": "echo is unknown"}).encode()
        self.send_response(status)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def choices(self, body: Mapping[str, Any]) -> list[dict[str, Any]]:
        lacks, prompt = self.server.lacks, str(body["prompt"])
        if body.get("echo") and lacks != "echo":
            head, answer = prompt.rsplit("Answer:\n", 1)
            return [self.choice(f"{head}Answer:\n", answer, f"{head}Answer:\n")]
        said = [*WITH, "straight"] if not body.get("echo") else ["and so on"]
        return [self.choice(prompt, answer, "") for answer in said]

    def choice(self, prompt: str, answer: str, echoed: str) -> dict[str, Any]:
        """The answer's value lies on its first letter; letters of the prompt have values that must not count."""
        table = WITH if "turned left" in prompt else WITHOUT
        values = [None, *([-9.0] * (len(echoed) - 1))] if echoed else []
        values += [table.get(answer, -20.0), *([0.0] * (len(answer) - 1))]
        told = None if self.server.lacks == "logprobs" else {
            "token_logprobs": values, "text_offset": list(range(len(values)))
        }  # fmt: skip
        finish = "length" if self.server.lacks == "ends" else "stop"
        return {"text": echoed + answer, "logprobs": told, "finish_reason": finish}

    def log_message(self, *args: Any) -> None:
        """Keep the test output quiet."""


@pytest.fixture
def service() -> Iterator[Service]:
    server = Service()
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.shutdown()
    server.server_close()
    thread.join()


def backbone(service: Service, **fields: Any) -> OpenAISamples:
    url = f"http://127.0.0.1:{service.server_port}/v1"
    return OpenAISamples.model_validate({"model": "m", "base_url": url, "retries": 0, "samples": 4} | fields)


def test_without_contrast_the_likeliest_answer_is_taken_and_nothing_else_is_asked(service: Service) -> None:
    found = backbone(service).generate(CONTEXT, QUERY, Greedy())
    assert found.text == "straight"
    assert found.model_calls == len(service.seen) == 1
    assert found.notes == ("the likeliest of 3 different answers",)


@pytest.mark.parametrize(("alpha", "expected"), [(0.1, "straight"), (0.7, "left"), (1.5, "left")])
def test_contrast_prefers_what_the_report_made_likelier(service: Service, alpha: float, expected: str) -> None:
    found = backbone(service).generate(CONTEXT, QUERY, Cad(alpha=alpha))
    assert found.text == expected
    scores = {text: (1 + alpha) * WITH[text] - alpha * WITHOUT[text] for text in WITH}
    assert max(scores, key=scores.__getitem__) == expected
    assert found.model_calls == 1 + 3
    assert all("turned left" not in body["prompt"] for body in service.seen[1:])
    assert f"alpha {alpha:g}" in found.notes[0]


def test_equal_samples_are_scored_once_and_the_schema_is_sent(service: Service) -> None:
    query = QUERY.model_copy(update={"answer_schema": {"type": "string"}})
    backbone(service).generate(CONTEXT.model_copy(update={"diagrams": (diagram(),)}), query, Cad())
    first, *scored = service.seen
    assert first["n"] == 4
    assert first["response_format"]["json_schema"]["schema"] == {"type": "string"}
    assert len(scored) == 3
    backbone(service, schema_mode="none").generate(CONTEXT, query, Greedy())
    assert "response_format" not in service.seen[-1]


@pytest.mark.parametrize(("lacks", "why"), [
    ("logprobs", "tells no log-probabilities of the answer"),
    ("echo", r"does not score a given text \(echo with text_offset\), so log p\(y\|x\) of an answer is not known"),
    ("echo refused", "may take no echo"),
])  # fmt: skip
def test_a_service_that_does_not_tell_enough_is_refused_with_the_reason(service: Service, lacks: str, why: str) -> None:
    service.lacks = lacks
    with pytest.raises(ConfigError, match=why):
        backbone(service).generate(CONTEXT, QUERY, Cad())


def test_answers_that_do_not_end_are_not_ranked(service: Service) -> None:
    service.lacks = "ends"
    with pytest.raises(InvalidOutput, match="none of 4 answers ended within 2048 tokens"):
        backbone(service).generate(CONTEXT, QUERY, Cad())


@pytest.mark.parametrize("decoder", [AdaCad(), Vcd()], ids=lambda d: type(d).__name__)
def test_decoders_of_tokens_or_pictures_are_refused(service: Service, decoder: Any) -> None:
    with pytest.raises(ConfigError, match="ranks whole answers by one alpha"):
        backbone(service).generate(CONTEXT.model_copy(update={"diagrams": (diagram(),)}), QUERY, decoder)
    assert service.seen == []


_LOGP = st.floats(-50, 0)


@given(_LOGP, _LOGP, _LOGP, _LOGP, st.floats(0, 3))
def test_the_order_is_that_of_the_evidence_less_a_share_of_the_prior(
    one: float, one_prior: float, two: float, two_prior: float, alpha: float
) -> None:
    share = alpha / (1 + alpha)
    gap = (one - share * one_prior) - (two - share * two_prior)
    scored = Sample("a", one, one_prior).score(alpha) - Sample("b", two, two_prior).score(alpha)
    assert scored == pytest.approx((1 + alpha) * gap, abs=1e-9)
