"""Several views of one drawing: their predictions are averaged, and only where there is something to see."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch
from PIL import Image
from pydantic import ValidationError

from plugins.backbone.engine.check import reference
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Prompt, Request
from plugins.backbone.engine.scoring import averaged
from plugins.backbone.hf_load import shifted_view
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from sgcad_core.case.records import Query
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import folders, tiny

EOS = frozenset({2})
TOKENS = 12
QUERY = Query(task="Describe the road.", answer_schema=tiny.SCHEMA)


def seen(name: str, prompt: Prompt, seed: int) -> Prompt:
    """The same words beside another picture of the same size."""
    return Prompt(prompt.ids, [tiny.picture(name, seed)])


def plain(name: str, request: Request) -> list[int]:
    """The answer by separate forward passes."""
    model, family = tiny.build(name)
    ids: list[int] = []
    while len(ids) < TOKENS:
        rows = [reference(model, family, one, ids)[-1][None] for one in (request.with_context, *request.views)]
        mean = torch.stack([row.float().log_softmax(-1) for row in rows]).mean(0) if request.views else rows[0]
        prior = reference(model, family, request.without_context, ids)[-1][None] if request.without_context else None
        ids.append(int(request.policy.scores(mean, prior).argmax()))
        if ids[-1] in EOS:
            return ids[:-1]
    return ids


@pytest.mark.parametrize("decoder", [Greedy(), Cad(alpha=0.7)], ids=["greedy", "cad"])
@pytest.mark.parametrize("name", ["qwen2_5_vl", "llava", "mllama"])
def test_views_are_the_mean_of_separate_forwards(name: str, decoder: Decoder) -> None:
    model, family = tiny.build(name)
    engine = engine_of(model, family, apart=True)
    with_, without = tiny.prompts(name, family, 0)
    views = [seen(name, with_, 6), seen(name, with_, 12)]
    request = Request(with_, without if decoder.reads_prior() else None, decoder, None, 0, TOKENS, EOS, views=views)
    alone = Request(with_, request.without_context, decoder, None, 0, TOKENS, EOS)
    asked = [engine.submit(one) for one in (request, alone, request)]
    first, without_views, again = (one.result(60) for one in asked)
    engine.close()
    assert first.ids == plain(name, request) == again.ids
    assert without_views.ids == plain(name, alone)
    assert first.prompt_tokens == without_views.prompt_tokens + sum(len(view.ids) for view in views)
    assert bool(first.without_context) == decoder.reads_prior()


def test_views_of_the_same_picture_change_nothing() -> None:
    model, family = tiny.build("qwen2_5_vl")
    engine = engine_of(model, family)
    with_, without = tiny.prompts("qwen2_5_vl", family, 0)
    one, three = (
        engine.generate(Request(with_, without, Cad(), None, 0, TOKENS, EOS, views=[with_] * count)) for count in (0, 2)
    )
    engine.close()
    assert one.ids == three.ids
    assert one.with_context == pytest.approx(three.with_context, abs=1e-4)


def test_averaging_is_the_geometric_mean_whatever_is_added_to_a_row() -> None:
    rows = torch.randn(3, 4, 9, generator=torch.Generator().manual_seed(0))
    mean = averaged(rows[0], list(rows[1:]))
    expected = rows.softmax(-1).log().mean(0).softmax(-1)
    assert torch.allclose(mean.softmax(-1), expected, atol=1e-6)
    assert torch.allclose(averaged(rows[0] + 5, list(rows[1:])), mean, atol=1e-5)
    assert torch.equal(averaged(rows[0], []), rows[0])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folders.save("qwen2_5_vl", tmp_path_factory.mktemp("qwen"))


def backbone(folder: Path, views: int) -> HfVision:
    return HfVision(model=str(folder), device="cpu", dtype="float32", max_new_tokens=200, views=views)


def test_a_model_reads_each_view_and_a_report_without_a_diagram_costs_nothing_more(folder: Path) -> None:
    one, three = backbone(folder, 1), backbone(folder, 3)
    drawn, told = folders.context(), folders.context(pictures=0)
    counts = [made.generate(drawn, QUERY, Cad()).prompt_tokens for made in (one, three)]
    assert counts[1] > 2 * counts[0]
    texts = [made.generate(told, QUERY, Cad()) for made in (one, three)]
    assert texts[0].prompt_tokens == texts[1].prompt_tokens
    assert texts[0].text == texts[1].text
    assert json.loads(three.generate(drawn, QUERY, Greedy()).text)


def test_every_view_is_a_picture_of_its_own(folder: Path) -> None:
    prompter = backbone(folder, 3)._loaded().prompter
    pictures = [prompter.picture(folders.diagram(), view) for view in range(5)]
    assert len({picture.digest[:12] for picture in pictures}) == 5, "kept beginnings are told apart by these"
    assert prompter.picture(folders.diagram()) is pictures[0]
    first = pictures[0].inputs["pixel_values"]
    for other in pictures[1:]:
        values = other.inputs["pixel_values"]
        assert values.shape != first.shape or not torch.equal(values, first)


def test_a_moved_picture_is_whole_and_lies_elsewhere_in_every_view() -> None:
    picture = Image.new("RGB", (100, 50), "black")
    views = [shifted_view(picture, view) for view in range(5)]
    assert views[0] is picture
    boxes = set()
    for view in views[1:]:
        ink = view.convert("L").point(lambda level: 255 - level).getbbox()
        assert ink is not None
        assert (ink[2] - ink[0], ink[3] - ink[1]) == picture.size
        boxes.add((view.size, ink))
    assert len(boxes) == 4


def test_more_views_than_there_are_is_a_config_error() -> None:
    with pytest.raises(ValidationError, match="less than or equal to 5"):
        HfVision(model="plugins/backbone/mini/weights", views=6)
