"""Decoding through a server: token for token what the same model gives in process, and what is said where it cannot."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest
import torch

from flows.catalogue import served
from plugins.backbone.hf_vision import HfVision
from plugins.backbone.openai_server import OpenAIServer
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.plausible import Plausible
from plugins.decoder.vcd import Vcd
from research.benchmarks.decoding.served import serving
from research.benchmarks.decoding.served_model import ServedModel
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import BadInput, ConfigError, InvalidOutput, MissingTool
from sgcad_core.interfaces import Decoder
from tests.effort import spread
from tests.plugins.backbone import tiny
from tests.plugins.backbone.folders import context, save

WHOLE = tiny.VOCABULARY
LIMIT = 32
SCHEMA = {
    "type": "object",
    "properties": {
        "bearing": {"type": "string", "enum": ["N", "NE", "E", "SE", "S"]},
        "lanes_in": {"type": "integer", "minimum": 0, "maximum": 12},
        "name": {"type": "string", "maxLength": 3},
        "speed": {"anyOf": [{"type": "integer", "minimum": 5, "maximum": 85}, {"type": "null"}]},
    },
    "required": ["bearing", "lanes_in", "name", "speed"],
    "additionalProperties": False,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save("text_only", tmp_path_factory.mktemp("model"))


@pytest.fixture(scope="module")
def model(folder: Path) -> ServedModel:
    return ServedModel(folder, window=1024)


@pytest.fixture(scope="module")
def url(model: ServedModel) -> Iterator[str]:
    with serving(model, "tiny") as address:
        yield address


@pytest.fixture(autouse=True)
def _no_limit(model: ServedModel) -> Iterator[None]:
    model.most = None
    yield
    model.most = None


@pytest.fixture(scope="module")
def inside(folder: Path) -> HfVision:
    return HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=LIMIT)


def through(url: str, folder: Path, **fields: object) -> OpenAIServer:
    known = {"base_url": url, "model": "tiny", "tokenizer": str(folder), "max_new_tokens": LIMIT, "backoff_s": 0.01}
    return OpenAIServer.model_validate({**known, "protocol": "sglang", **fields})


def question(schema: bool = True) -> Query:
    return Query(task="Tell.", answer_schema=SCHEMA if schema else None)


def report(seed: int) -> Context:
    return context(seed, pictures=0)


def assert_same(found: Generation, wanted: Generation) -> None:
    assert [t.text for t in found.tokens] == [t.text for t in wanted.tokens]
    assert [t.forced for t in found.tokens] == [t.forced for t in wanted.tokens]
    assert found.finish == wanted.finish
    ours, theirs = (torch.tensor([t.logp_with_context for t in one.tokens]) for one in (found, wanted))
    assert torch.allclose(ours, theirs, atol=1e-3)
    assert found.grounding == pytest.approx(wanted.grounding, abs=1e-2)


ASKED = [
    (Cad(alpha=0.3), True, WHOLE),
    (Cad(alpha=1.5), False, WHOLE),
    (Cad(alpha=0.7, beta=0.1), True, 20),
    (Cad(alpha=0.7), False, 40),
]


@pytest.mark.parametrize(
    ("protocol", "decoder", "schema", "top"),
    spread([(protocol, *asked) for protocol, asked in product(("vllm", "sglang", "llama_cpp"), ASKED)], 5),
)
def test_tokens_equal_those_in_process(
    protocol: str, decoder: Decoder, schema: bool, top: int, url: str, folder: Path, inside: HfVision
) -> None:
    server = through(url, folder, protocol=protocol, top_logprobs=top)
    wanted = inside.generate(report(1), question(schema), decoder)
    assert_same(server.generate(report(1), question(schema), decoder), wanted)


@pytest.mark.parametrize("decoder", [AdaCad(), Greedy(), Plausible()])
def test_every_decoder_works_as_in_process(decoder: Decoder, url: str, folder: Path, inside: HfVision) -> None:
    server = through(url, folder, top_logprobs=WHOLE)
    wanted = inside.generate(report(2), question(), decoder)
    assert_same(server.generate(report(2), question(), decoder), wanted)


@pytest.mark.slow
def test_a_sampled_answer_is_the_one_in_process_of_the_same_seed(url: str, folder: Path, inside: HfVision) -> None:
    server, decoder = through(url, folder, top_logprobs=WHOLE), Cad(alpha=0.7, temperature=0.9, top_p=0.8)
    for seed in (1, 2):
        wanted = inside.generate(report(3), question(False), decoder, seed)
        assert_same(server.generate(report(3), question(False), decoder, seed), wanted)


def test_a_short_draft_changes_the_rounds_and_not_the_answer(url: str, folder: Path) -> None:
    long, short = (through(url, folder, top_logprobs=WHOLE, draft_tokens=n) for n in (64, 2))
    answers = [one.generate(report(4), question(False), Greedy()) for one in (long, short)]
    assert answers[0].text == answers[1].text
    assert answers[0].model_calls < answers[1].model_calls


def test_a_top_k_too_small_is_counted_and_said(url: str, folder: Path, model: ServedModel) -> None:
    model.most = 5
    found = through(url, folder, protocol="vllm", top_logprobs=20).generate(report(5), question(False), Cad(alpha=1.5))
    assert any("are right only if no token outside the top 5 would have won" in note for note in found.notes)


def test_a_larger_top_k_is_asked_for_where_the_first_does_not_decide(url: str, folder: Path) -> None:
    found = through(url, folder, top_logprobs=3).generate(report(5), question(False), Cad(alpha=1.5))
    assert any(note.startswith("top 3 did not decide") for note in found.notes)
    assert not any("right only if" in note for note in found.notes)


# ------------------------------------------------------------------ what cannot be
def test_a_tokenizer_of_another_model_is_named(url: str, folder: Path, tmp_path: Path) -> None:
    save("text_only", tmp_path)
    file = tmp_path / "tokenizer.json"
    known = json.loads(file.read_text())
    known["model"]["merges"] = known["model"]["merges"][:3]
    file.write_text(json.dumps(known))
    with pytest.raises(ConfigError, match=r"is not the tokenizer of the server .* differs from token \d+ on"):
        through(url, tmp_path).load()


def test_a_server_without_prompt_logprobs_is_refused(
    url: str, folder: Path, model: ServedModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    model.most = 0
    with pytest.raises(ConfigError, match=r"takes no prompt_logprobs.*decoder 'greedy'"):
        through(url, folder, protocol="vllm").load()


def test_a_model_that_the_server_does_not_have_is_named(url: str, folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"backbone\.model 'other': the server at .* has tiny; use that name"):
        through(url, folder, model="other").load()


def test_a_server_that_is_not_there_is_named(url: str, folder: Path) -> None:
    with pytest.raises(MissingTool, match=r"127\.0\.0\.1:9/v1/models gave no answer in 1 tries"):
        through("http://127.0.0.1:9", folder, retries=0).load()


def test_a_server_that_dies_half_way_is_named_after_its_retries(folder: Path, model: ServedModel) -> None:
    with serving(model, "tiny") as address:
        server = through(address, folder, retries=1)
        server.load()
    with pytest.raises(MissingTool, match="gave no answer in 2 tries"):
        server.generate(report(1), question(), Cad())


def test_a_fault_that_passes_is_asked_again(
    url: str, folder: Path, inside: HfVision, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fastapi import HTTPException

    own, asked = ServedModel.scored, [0]

    def busy(model: ServedModel, ids: list[int], count: int) -> torch.Tensor:
        asked[0] += 1
        if asked[0] == 3:
            raise HTTPException(503, "busy")
        return own(model, ids, count)

    monkeypatch.setattr(ServedModel, "scored", busy)
    found = through(url, folder, top_logprobs=WHOLE).generate(report(1), question(), Cad(alpha=0.3))
    assert_same(found, inside.generate(report(1), question(), Cad(alpha=0.3)))


def test_an_answer_that_does_not_fit_is_invalid_output(url: str, folder: Path) -> None:
    with pytest.raises(InvalidOutput, match="not finished after 6 tokens"):
        through(url, folder, max_new_tokens=6).generate(report(1), question(), Cad(beta=0.1))


def test_a_prompt_longer_than_the_servers_window_is_bad_input(url: str, folder: Path) -> None:
    with pytest.raises(BadInput, match=r"window is 1024; set backbone\.truncate"):
        through(url, folder).generate(Context(narrative="V1 struck V2. " * 200), question(), Cad())


def test_a_decoder_that_contrasts_pictures_is_refused(url: str, folder: Path) -> None:
    with pytest.raises(ConfigError, match="Vcd contrasts pictures, which backbone 'openai_server' does not send"):
        through(url, folder).generate(context(1), question(), Vcd())


def test_the_check_of_a_config_tells_what_the_server_offers(url: str, folder: Path, model: ServedModel) -> None:
    model.most = 20
    lines = through(url, folder, protocol="vllm").offers(Cad())
    assert f"tiny at {url} (vllm), a window of 1024 tokens; it spells a sample" in lines[0]
    assert "top 20 asked, at most 20 of 300" in lines[1]
    assert "cannot be excluded without beta" in lines[2]
    assert len(through(url, folder, protocol="vllm").offers(Cad(beta=0.1))) == 2


def test_the_check_of_a_config_whose_server_is_away_says_so(folder: Path) -> None:
    from types import SimpleNamespace

    config = SimpleNamespace(backbone=through("http://127.0.0.1:9", folder), decoder=Cad())
    (line,) = served(config)  # type: ignore[arg-type]
    assert line.startswith("backbone: http://127.0.0.1:9/v1/models gave no answer in 1 tries")


# ------------------------------------------------------------------ pictures
@pytest.mark.slow
@pytest.mark.parametrize("name", ["llava", "qwen2_5_vl"])
def test_tokens_behind_pictures_equal_those_in_process(name: str, tmp_path: Path) -> None:
    """Diagrams go out as data URLs; the contrast is with a row that sees neither narrative nor picture."""
    folder = save(name, tmp_path)
    inside = HfVision(model=str(folder), dtype="float32", device="cpu", max_new_tokens=90)
    known = {"protocol": "vllm", "max_new_tokens": 90, "top_logprobs": WHOLE}
    with serving(ServedModel(folder, window=1024), "tiny") as address:
        server = through(address, folder, **known, pictures=True)
        narrow = through(address, folder, **{**known, "top_logprobs": 20}, pictures=True)
        for decoder in (Cad(alpha=0.7), Cad(alpha=1.5, beta=0.1), Greedy()):
            wanted = inside.generate(context(1), question(), decoder)
            assert_same(server.generate(context(1), question(), decoder), wanted)
        assert_same(
            narrow.generate(context(2), question(), Cad(beta=0.1)),
            inside.generate(context(2), question(), Cad(beta=0.1)),
        )
        unseen = through(address, folder, **known).generate(context(1), question(), Cad())
        assert "the model is shown no pictures: diagrams are left out" in unseen.notes
        others = [context(1).model_copy(update={"diagrams": context(n).diagrams}) for n in (1, 9)]
        seen = [server.generate(other, question(), Greedy()) for other in others]
        assert seen[0].tokens[0].logp_with_context != seen[1].tokens[0].logp_with_context, "another picture"


def test_pictures_through_another_protocol_are_refused_by_name(folder: Path) -> None:
    with pytest.raises(ValueError, match="protocol sglang takes no tokens with pictures; set protocol vllm"):
        through("http://127.0.0.1:9", folder, pictures=True)


def test_a_server_that_renders_no_pictures_is_told(url: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from research.benchmarks.decoding.served import Pages

    monkeypatch.setattr(Pages, "render", lambda *_: {"token_ids": [1, 2, 3], "features": None})
    with serving(ServedModel(folder, window=1024), "tiny") as address:
        server = through(address, folder, protocol="vllm", pictures=True)
        with pytest.raises(
            ConfigError, match="rendered no pictures; start vLLM with VLLM_ENABLE_SCALE_OUT_ENDPOINTS=1"
        ):
            server.generate(context(1), question(), Cad())
