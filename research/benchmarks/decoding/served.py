"""A server over HTTP that speaks vLLM's, SGLang's and llama.cpp's protocols about one small model.

    python -m research.benchmarks.decoding.served FOLDER [--port 8000] [--most 20]

For tests and for trying `openai_server` where no GPU is: the pages and fields that contrast needs, as those servers
document them, no more. Knows nothing of contrast: it writes and scores what it is asked.
"""

from __future__ import annotations

import argparse
import base64
import json
import re
import socket
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import uvicorn
from fastapi import FastAPI, HTTPException
from fastapi.responses import Response
from torch import Tensor

from research.benchmarks.decoding.served_model import ServedModel

Body = dict[str, Any]
_TOKEN = re.compile(r"<\[(\d+)\]>")


def app_of(model: ServedModel, name: str) -> FastAPI:
    """The pages of a server whose model has that name."""
    app = FastAPI()
    pages = Pages(model, name)
    app.get("/v1/models")(pages.models)
    for path, page in {
        "/tokenize": pages.tokenize,
        "/v1/completions": pages.completions,
        "/v1/chat/completions/render": pages.render,
        "/inference/v1/generate": pages.tokens_out,
        "/generate": pages.generate,
        "/completion": pages.completion,
    }.items():
        app.post(path)(plain(page))
    return app


def plain(page: Callable[[Body], Body]) -> Callable[[Body], Response]:
    """The page with its answer written at once: FastAPI's own way looks at every one of many thousand numbers."""

    def answer(body: Body) -> Response:
        return Response(json.dumps(page(body)), media_type="application/json")

    return answer


@dataclass
class Pages:
    """Answers of the pages, each by its server's documentation. `sent` counts requests by page."""

    model: ServedModel
    name: str
    sent: dict[str, int] = field(default_factory=dict)

    def models(self) -> Body:
        """The one model."""
        return {"object": "list", "data": [{"id": self.name, "object": "model", "max_model_len": self.model.window}]}

    def tokenize(self, body: Body) -> Body:
        """Tokens of `prompt` (vLLM, SGLang) or `content` (llama.cpp)."""
        return {"tokens": self.model.tokens(str(body.get("prompt", body.get("content", ""))))}

    # ------------------------------------------------------------------ vLLM
    def completions(self, body: Body) -> Body:
        """vLLM's completions of one prompt of token ids, or of several."""
        if body.get("model") != self.name:
            raise HTTPException(404, f"The model `{body.get('model')}` does not exist.")
        for asked in ("prompt_logprobs", "logprobs"):
            self._check_top(asked.replace("_", " "), body.get(asked))
        prompts = body["prompt"] if isinstance(body["prompt"][0], list) else [body["prompt"]]
        next_only = body.get("prompt_logprobs") is None and int(body.get("max_tokens", 16)) == 1
        rows = self._next_rows(prompts) if next_only else [None] * len(prompts)
        choices = [self._choice(i, ids, body, rows[i]) for i, ids in enumerate(prompts)]
        return {"object": "text_completion", "choices": choices}

    def _next_rows(self, prompts: Sequence[list[int]]) -> list[Tensor]:
        """Log-probabilities behind each prompt, in one batch; what is a beginning of another prompt is read once."""
        groups: list[tuple[list[int], list[int]]] = []
        for i in sorted(range(len(prompts)), key=lambda i: -len(prompts[i])):
            longer = (same for ids, same in groups if prompts[i] == ids[: len(prompts[i])])
            same = next(longer, None)
            if same is None:
                groups.append((prompts[i], same := []))
            same.append(i)
        texts = [(ids, len(ids) - len(prompts[same[-1]]) + 1) for ids, same in groups]
        scored = self.model.scored_all(texts)
        found = {
            i: rows[len(prompts[i]) - len(ids) - 1]
            for (ids, same), rows in zip(groups, scored, strict=True)
            for i in same
        }
        return [found[i] for i in range(len(prompts))]

    def _check_top(self, what: str, asked: int | None) -> None:
        top = self.model.vocabulary if asked == -1 else asked or 0
        if top > self.model.limit:
            raise HTTPException(
                400, f"Requested {what} of {top}, which is greater than max allowed: {self.model.limit}"
            )

    def _choice(self, index: int, ids: list[int], body: Body, row: Tensor | None) -> Body:
        model, limit = self.model, int(body.get("max_tokens", 16))
        if len(ids) + limit > model.window:
            raise HTTPException(400, f"This model's maximum context length is {model.window} tokens.")
        guided = (body.get("structured_outputs") or {}).get("json")
        asked, choice = body.get("prompt_logprobs"), Body(index=index, logprobs=None, prompt_logprobs=None)
        tops, rows = body.get("logprobs"), list[Tensor]()
        if row is not None:
            tokens, rows = self._allowed(row, body.get("allowed_token_ids")), [row]
        elif asked is None:
            tokens, rows = model.written(ids, limit, guided, told=tops is not None)
        else:
            inside = model.scored(ids, len(ids))
            places = [_entries(row, model.vocabulary if asked == -1 else asked, ids[i + 1]) for i, row in
                      enumerate(inside[:-1])]  # fmt: skip
            choice["prompt_logprobs"] = [None, *({str(t): {"logprob": v} for t, v in place} for place in places)]
            tokens, rows = [int(inside[-1].argmax())], [inside[-1]]
        if tops is not None:
            named = body.get("logprob_token_ids") if model.tells_named else None
            told = [
                _named(at, named, t) if named else _entries(at, tops, t) for at, t in zip(rows, tokens, strict=True)
            ]
            choice["logprobs"] = {"top_logprobs": [{f"token_id:{t}": v for t, v in place} for place in told]}
        ended = bool(tokens) and tokens[-1] in model.eos
        text = model.bytes(tokens).decode("utf-8", errors="replace")
        return {**choice, "text": text, "token_ids": tokens, "finish_reason": "stop" if ended else "length"}

    @staticmethod
    def _allowed(row: Tensor, allowed: list[int] | None) -> list[int]:
        """The most likely token, of all or of the allowed ones."""
        return [int(row.argmax()) if allowed is None else max(allowed, key=lambda token: float(row[token]))]

    def render(self, body: Body) -> Body:
        """vLLM's rendering of one user's turn: token ids, and features that `tokens_out` takes back."""
        content = body["messages"][0]["content"]
        blocks = [one["text"] if one["type"] == "text" else _png(one["image_url"]["url"]) for one in content]
        data = [base64.b64encode(block).decode() for block in blocks if isinstance(block, bytes)]
        return {"token_ids": self.model.rendered(blocks), "features": {"kwargs_data": {"image": data}}}

    def tokens_out(self, body: Body) -> Body:
        """vLLM's generation from token ids and features; log-probabilities of the prompt behind its pictures only."""
        ids, asked, model = body["token_ids"], body["sampling_params"], self.model
        shown = [model.picture(base64.b64decode(data)) for data in body["features"]["kwargs_data"]["image"]]
        if asked.get("logprobs") is None:
            guided = (asked.get("structured_outputs") or {}).get("json")
            tokens, _ = model.written(ids, int(asked["max_tokens"]), guided, pictures=shown)
            return {"choices": [{"index": 0, "token_ids": tokens, "logprobs": None}], "prompt_logprobs": None}
        top, told = int(asked["logprobs"]), asked.get("prompt_logprobs") is not None
        first = max(i for i, token in enumerate(ids) if token == model.runner.family.image_token) + 2
        rows = model.scored(ids, len(ids) - first + 1 if told else 1, shown)
        inside = [dict(_entries(row, top, ids[first + i])) for i, row in enumerate(rows[:-1])]
        token = int(rows[-1].argmax())
        best = [{"token": f"token_id:{t}", "logprob": v} for t, v in _entries(rows[-1], top, token)]
        choice = {"index": 0, "token_ids": [token], "logprobs": {"content": [{"top_logprobs": best}]}}
        places = [*[None] * first, *({str(t): {"logprob": v} for t, v in place.items()} for place in inside)]
        return {"choices": [choice], "prompt_logprobs": places if told else None}

    # ------------------------------------------------------------------ SGLang
    def generate(self, body: Body) -> Body:
        """SGLang's own generation from `input_ids`."""
        ids, sampling = body["input_ids"], body.get("sampling_params") or {}
        limit, schema = int(sampling.get("max_new_tokens", 128)), sampling.get("json_schema")
        if not body.get("return_logprob"):
            tokens, _ = self.model.written(ids, limit, json.loads(schema) if schema else None)
            return {"text": "", "output_ids": tokens, "meta_info": {"prompt_tokens": len(ids)}}
        start = body.get("logprob_start_len", -1)
        start = len(ids) - 1 if start == -1 else start
        rows, top = self.model.scored(ids, len(ids) - start), int(body.get("top_logprobs_num", 0))
        token = int(rows[-1].argmax())
        meta = {
            "prompt_tokens": len(ids),
            "input_token_logprobs": [_first(ids[start]), *(_entry(rows[i], t) for i, t in enumerate(ids[start + 1 :]))],
            "input_top_logprobs": [None, *(_tops(row, top) for row in rows[:-1])],
            "output_token_logprobs": [_entry(rows[-1], token)],
            "output_top_logprobs": [_tops(rows[-1], top)],
            "output_token_ids_logprobs": [[_entry(rows[-1], t) for t in body.get("token_ids_logprob") or ()]],
        }
        return {"text": "", "output_ids": [token], "meta_info": meta}

    # ------------------------------------------------------------------ llama.cpp
    def completion(self, body: Body) -> Body:
        """llama.cpp's completion of token ids; of grammars a row of token numbers."""
        grammar, top = str(body.get("grammar") or ""), int(body.get("n_probs", 0))
        text = [int(number) for number in _TOKEN.findall(grammar)]
        tokens, rows = self.model.written(body["prompt"], int(body["n_predict"]), text=text)
        told = [
            {"id": token, "logprob": float(row[token]), "top_logprobs": [{"id": t, "logprob": v} for v, t, _ in best]}
            for token, row in zip(tokens, rows, strict=True)
            for best in [_tops(row, top)]
        ]
        return {"tokens": tokens, "completion_probabilities": told}


def _entries(row: Tensor, top: int, token: int) -> list[tuple[int, float]]:
    """The most likely tokens, and the one that stands there if it is not among them."""
    found = {int(t): float(v) for v, t, _ in _tops(row, top)}
    return list({**found, token: float(row[token])}.items())


def _named(row: Tensor, named: Sequence[int], token: int) -> list[tuple[int, float]]:
    """The values of given tokens, and of the one that was written."""
    return [(t, float(row[t])) for t in dict.fromkeys([*named, token])]


def _tops(row: Tensor, top: int) -> list[list[Any]]:
    values, tokens = row.topk(min(top, len(row)))
    return [[value, token, None] for value, token in zip(values.tolist(), tokens.tolist(), strict=True)]


def _entry(row: Tensor, token: int) -> list[Any]:
    return [float(row[token]), token, None]


def _first(token: int) -> list[Any]:
    """The first place has no log-probability: nothing stands before it."""
    return [None, token, None]


def _png(url: str) -> bytes:
    return base64.b64decode(url.partition("base64,")[2])


@contextmanager
def serving(model: ServedModel, name: str) -> Iterator[str]:
    """The server's address, while it answers on a thread of its own."""
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        server = uvicorn.Server(uvicorn.Config(app_of(model, name), log_level="error", lifespan="off"))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [bound]}, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{bound.getsockname()[1]}"
        finally:
            server.should_exit = True
            thread.join()


def main(arguments: Sequence[str] | None = None) -> None:
    """Serve a folder's model until stopped."""
    known = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    known.add_argument("folder", type=Path)
    known.add_argument("--port", type=int, default=8000)
    known.add_argument("--most", type=int, help="largest top k; the whole vocabulary if not given")
    told = known.parse_args(arguments)
    uvicorn.run(app_of(ServedModel(told.folder, most=told.most), told.folder.name), port=told.port)


if __name__ == "__main__":
    main()
