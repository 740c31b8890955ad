"""The server embedder over real HTTP: batches, order, faults that pass and faults that stay."""

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from plugins.retriever.knowledge import embedders
from sgcad_core.errors import ConfigError, MissingTool


class Answers(BaseHTTPRequestHandler):
    """Answers as the server's `plan` says, one entry a request; "good" at its end."""

    def do_POST(self):
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.seen.append((self.path, self.headers.get("Authorization"), body))
        status, answer = self.server.plan.pop(0) if self.server.plan else (200, None)
        if answer is None:
            data = [{"index": i, "embedding": [len(text), 1.0]} for i, text in enumerate(body["input"])]
            answer = json.dumps({"data": data[::-1]})  # out of order, as the interface allows
        self.send_response(status)
        self.end_headers()
        self.wfile.write(answer.encode())

    def log_message(self, *args):
        """Quiet."""


@pytest.fixture
def server(monkeypatch):
    monkeypatch.setattr(embedders.time, "sleep", lambda seconds: None)
    made = ThreadingHTTPServer(("127.0.0.1", 0), Answers)
    made.plan, made.seen = [], []
    made.url = f"http://127.0.0.1:{made.server_port}/v1"
    threading.Thread(target=made.serve_forever, daemon=True).start()
    yield made
    made.shutdown()
    made.server_close()


def embedder(server, key_env="SGCAD_TEST_KEY"):
    return embedders.make("openai", "ada", server.url, key_env)


def test_vectors_come_in_the_order_of_the_texts_in_batches(server, monkeypatch):
    monkeypatch.setenv("SGCAD_TEST_KEY", "secret")
    vectors = embedder(server).embed(["x" * n for n in range(1, 41)])
    assert vectors.shape == (40, 2)
    assert np.allclose(vectors[:, 0] / vectors[:, 1], range(1, 41), rtol=1e-4)
    assert [len(body["input"]) for _, _, body in server.seen] == [32, 8]
    assert server.seen[0][:2] == ("/v1/embeddings", "Bearer secret")
    assert server.seen[0][2]["model"] == "ada"


def test_faults_that_pass_are_tried_again(server):
    server.plan = [(429, "slow down"), (503, "busy"), (500, "oops")]
    assert embedder(server).embed(["one"]).shape == (1, 2)
    assert len(server.seen) == 4


def test_a_server_that_stays_busy_is_an_error_in_the_end(server):
    server.plan = [(503, "busy")] * 9
    with pytest.raises(MissingTool, match=r"no answer after 5 attempts \(HTTP 503: busy\)"):
        embedder(server).embed(["one"])


@pytest.mark.parametrize(
    ("status", "answer", "says"),
    [
        (401, "no key", "refused the request: HTTP 401: no key; look at model, base_url and API key"),
        (200, "<html>", "the answer is no JSON"),
        (200, "{}", "holds no embeddings"),
        (200, '{"data": []}', "0 vectors for 1 texts"),
        (200, '{"data": [{"index": 0, "embedding": [NaN, 1]}]}', "or no finite numbers"),
    ],
)
def test_a_wrong_answer_is_told_and_not_tried_again(server, status, answer, says):
    server.plan = [(status, answer)]
    with pytest.raises(ConfigError, match=says):
        embedder(server).embed(["one"])
    assert len(server.seen) == 1


def test_a_server_that_is_not_there_is_named(server):
    gone = embedders.make("openai", "ada", "http://127.0.0.1:9/v1", "SGCAD_TEST_KEY")
    with pytest.raises(MissingTool, match=r"http://127.0.0.1:9/v1/embeddings: no answer after 5 attempts"):
        gone.embed(["one"])
