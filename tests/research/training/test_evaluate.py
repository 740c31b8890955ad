"""The shipped weights: small, loaded offline by transformers, answering in valid specs through the product's engine."""

import io
import json

import pytest
import torch
from transformers import AutoModelForImageTextToText, AutoTokenizer

from plugins.backbone.hf_vision import HfVision
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from research.generator.report import make_report
from research.renderer.draw import draw_report
from research.training.evaluate import answers_of, load
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Diagram, Query
from sgcad_core.records.specs import BehaviorSpec, RoadLayout
from sgcad_core.settings import ROOT
from tests.research.reports import text_report

WEIGHTS = ROOT / "plugins" / "backbone" / "mini" / "weights"
SEEDS = (60_000_001, 60_000_002)


@pytest.fixture(scope="module")
def backbone() -> HfVision:
    torch.set_num_threads(1)
    return HfVision(model=str(WEIGHTS), device="cpu", dtype="float32", pictures_first=False, max_new_tokens=512)


def context(seed: int) -> Context:
    report = make_report(seed, length=0.3, modes={"both": 1.0})
    image, out = draw_report(report), io.BytesIO()
    image.save(out, "PNG")
    diagram = Diagram(png=out.getvalue(), width_px=image.width, height_px=image.height)
    return Context(narrative=report.narrative, diagrams=(diagram,))


def test_weights_are_at_most_25_megabytes_and_have_a_card() -> None:
    assert sum(f.stat().st_size for f in WEIGHTS.iterdir()) <= 25e6
    assert "license" in (WEIGHTS / "README.md").read_text().lower()


def test_transformers_loads_them_offline(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    model = AutoModelForImageTextToText.from_pretrained(WEIGHTS)
    assert model.config.model_type == "qwen2_5_vl"
    assert len(AutoTokenizer.from_pretrained(WEIGHTS)) == model.config.text_config.vocab_size


@pytest.mark.parametrize("seed", SEEDS)
def test_both_queries_are_answered_in_valid_specs(backbone: HfVision, seed: int) -> None:
    task = load_prompt("mini_road")
    answer = backbone.generate(context(seed), Query(task=task, answer_schema=answer_schema(RoadLayout)), Cad(alpha=0.5))
    layout = parse_answer(answer.text, RoadLayout)
    ids = [leg.bearing for leg in layout.legs]
    query = Query(
        task=load_prompt("mini_scenario", roads=layout.model_dump_json()),
        answer_schema=answer_schema(BehaviorSpec, enums={"road": ids, "exit_road": ids}),
    )
    parse_answer(backbone.generate(context(seed), query, Cad(alpha=0.5)).text, BehaviorSpec)


@pytest.mark.slow
def test_the_products_engine_and_the_trainers_decoder_agree(backbone: HfVision) -> None:
    """Forced tokens, grammar and cached rows of two engines that share no code give one answer."""
    report = make_report(SEEDS[0], length=0.3, modes={"both": 1.0})
    road, _ = answers_of(*load(WEIGHTS), [report])[0]
    query = Query(task=load_prompt("mini_road"), answer_schema=answer_schema(RoadLayout))
    assert json.loads(backbone.generate(context(SEEDS[0]), query, Greedy()).text) == road


@pytest.mark.slow
def test_a_speed_of_one_digit_ends_alike_in_both_engines(backbone: HfVision) -> None:
    """A decoder that goes by tokens may write more digits where one that goes by whole values may not."""
    reports = (text_report(SEEDS[0] + i, length=0.2) for i in range(400))
    slow = [r for r in reports if r.behavior and any(a["speed_mph"] == 5 for a in r.behavior.get("actors", ()))][:3]
    for report, (road, behavior) in zip(slow, answers_of(*load(WEIGHTS), slow), strict=True):
        ids = [leg["bearing"] for leg in road["legs"]]
        query = Query(
            task=load_prompt("mini_scenario", roads=json.dumps(road, separators=(",", ":"))),
            answer_schema=answer_schema(BehaviorSpec, enums={"road": ids, "exit_road": ids}),
        )
        answer = json.loads(backbone.generate(Context(narrative=report.narrative), query, Greedy()).text)
        assert [(a["id"], a["speed_mph"]) for a in answer["actors"]] == [
            (a["id"], a["speed_mph"]) for a in behavior["actors"]
        ]
        assert 5 in [a["speed_mph"] for a in answer["actors"]]


@pytest.mark.slow
def test_answers_come_in_the_order_of_the_reports_whatever_they_have() -> None:
    model = load(WEIGHTS)
    modes = ("image", "text", "both", "text")
    reports = [make_report(60_000_100 + i, length=0.2, modes={mode: 1.0}) for i, mode in enumerate(modes)]
    assert answers_of(*model, reports, views=2, batch=3) == [answers_of(*model, [r], views=2)[0] for r in reports]
