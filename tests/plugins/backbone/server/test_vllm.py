"""What contrast asks a vLLM server for: guided drafts with their values, rare tokens by name, little read twice."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from plugins.backbone.hf_vision import HfVision
from plugins.backbone.openai_server import OpenAIServer
from plugins.backbone.server.http import ServerHttp
from plugins.backbone.server.vllm import Vllm
from plugins.decoder.cad import Cad
from research.benchmarks.decoding.served import Pages, serving
from research.benchmarks.decoding.served_model import ServedModel
from sgcad_core.case.records import Query
from tests.effort import spread
from tests.plugins.backbone.folders import context, save
from tests.plugins.backbone.test_openai_server import SCHEMA

_MASKED = Cad(alpha=0.3, beta=0.1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save("text_only", tmp_path_factory.mktemp("model"))


@pytest.fixture(scope="module")
def model(folder: Path) -> ServedModel:
    return ServedModel(folder, window=1024, most=20)


@pytest.fixture(scope="module")
def url(model: ServedModel) -> Iterator[str]:
    with serving(model, "tiny") as address:
        yield address


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Bodies of the requests for completions, as they come."""
    bodies, answer = list[dict[str, Any]](), Pages._choice

    def noted(self: Pages, index: int, ids: list[int], body: dict[str, Any], row: Any) -> dict[str, Any]:
        if not index:
            bodies.append(body)
        return answer(self, index, ids, body, row)

    monkeypatch.setattr(Pages, "_choice", noted)
    return bodies


def through(url: str, folder: Path) -> OpenAIServer:
    return OpenAIServer(base_url=url, model="tiny", tokenizer=str(folder), max_new_tokens=32, backoff_s=0.01)


def spoken(url: str) -> Vllm:
    speaker = Vllm(ServerHttp(url, "OPENAI_API_KEY", 30.0, 0, 0.01, {}), "tiny")
    speaker.offer()
    return speaker


def test_the_first_draft_is_guided_and_later_ones_are_short(url: str, folder: Path, asked: list[Any]) -> None:
    server = through(url, folder)
    server.load()
    asked.clear()
    server.generate(context(1, pictures=0), Query(task="Tell.", answer_schema=SCHEMA), _MASKED)
    drafts = [body for body in asked if body["max_tokens"] > 1]
    assert drafts[0]["structured_outputs"]["json"] == SCHEMA
    assert all(body["max_tokens"] <= 4 for body in drafts[1:])


def test_the_row_with_evidence_is_not_read_again_behind_its_draft(url: str, folder: Path, asked: list[Any]) -> None:
    server = through(url, folder)
    server.load()
    asked.clear()
    server.generate(context(1, pictures=0), Query(task="Tell.", answer_schema=SCHEMA), _MASKED)
    draft, scoring = asked[0]["prompt"], next(body for body in asked if "prompt_logprobs" in body)["prompt"]
    assert isinstance(scoring[0], int), "one prompt, not two rows"
    assert scoring[: len(draft)] != draft


def test_places_by_beginnings_are_those_of_the_whole_text(url: str) -> None:
    speaker, prompt = spoken(url), [3 + i % 90 for i in range(120)]
    whole = speaker.tops_of([prompt], [5, 6, 7], 4, 20)[0]
    assert speaker._way(prompt, [5, 6, 7], 4) == "beginnings", "the server has read it now"
    parts = speaker.tops_of([prompt], [5, 6, 7], 4, 20)[0]
    for one, other in zip(whole, parts, strict=True):
        assert one.known == pytest.approx(other.known, abs=1e-4)


def test_values_by_name_are_those_of_a_prompt_each(url: str, model: ServedModel) -> None:
    prompt, tokens = [3 + i % 90 for i in range(40)], [4, 9, 77]
    named = spoken(url)
    model.tells_named = False
    old = spoken(url)
    model.tells_named = True
    assert (named.named, old.named, old.at_once) == (128, 0, False)
    assert named.exact(prompt, [5], tokens) == pytest.approx(old.exact(prompt, [5], tokens), abs=1e-4)


@pytest.mark.parametrize(("schema", "tells_named"), spread(product((SCHEMA, None), (True, False)), 3))
def test_tokens_equal_those_in_process(
    tells_named: bool, schema: dict[str, Any] | None, url: str, folder: Path, model: ServedModel
) -> None:
    model.tells_named, model.most = tells_named, None
    inside = HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=32)
    query = Query(task="Tell.", answer_schema=schema)
    try:
        for alpha in (0.3, 1.5):
            decoder = Cad(alpha=alpha, beta=0.1)
            wanted = inside.generate(context(6, pictures=0), query, decoder)
            found = through(url, folder).generate(context(6, pictures=0), query, decoder)
            assert [t.text for t in found.tokens] == [t.text for t in wanted.tokens]
    finally:
        model.tells_named, model.most = True, 20


def test_values_behind_a_mask_are_not_taken_from_drafts(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert spoken(url).unmasked
    told = Pages._choice

    def processed(self: Pages, index: int, ids: list[int], body: dict[str, Any], row: Any) -> dict[str, Any]:
        choice = told(self, index, ids, body, row)
        if "allowed_token_ids" in body:
            choice["logprobs"]["top_logprobs"] = [{f"token_id:{choice['token_ids'][0]}": 0.0}]
        return choice

    monkeypatch.setattr(Pages, "_choice", processed)
    speaker = spoken(url)
    assert not speaker.unmasked
    assert speaker.draft_told([3, 4, 5], (), 4, None, 5)[1] == []
