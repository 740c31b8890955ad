"""The embedded model through transformers' own doors: AutoProcessor, a chat template, the model itself."""

from pathlib import Path

import pytest
import torch
from PIL import Image
from transformers import AutoModelForImageTextToText, AutoProcessor

import plugins.backbone.mini.processor
from research.generator.report import make_report
from research.model.tokens import ROAD
from research.renderer.draw import draw_report
from research.rows.collate import collate
from research.rows.report_rows import evidence
from research.training.evaluate import load

WEIGHTS = Path(__file__).parents[4] / "plugins" / "backbone" / "mini" / "weights"
NARRATIVE = "V1 was traveling north and the front of V1 struck the left side of V2."


@pytest.fixture(scope="module")
def processor() -> plugins.backbone.mini.processor.MiniProcessor:
    found = AutoProcessor.from_pretrained(WEIGHTS)
    assert isinstance(found, plugins.backbone.mini.processor.MiniProcessor)
    return found


def test_the_model_sees_what_it_saw_in_training(processor: plugins.backbone.mini.processor.MiniProcessor) -> None:
    report = make_report(60_000_004, length=0.2, modes={"both": 1.0})
    drawing = draw_report(report)
    talk = [
        {"type": "text", "text": report.narrative},
        {"type": "image", "image": drawing},
        {"type": "text", "text": "<|road|>"},
    ]
    inputs = processor.apply_chat_template([{"role": "user", "content": talk}])
    forward, coder, sight = load(WEIGHTS)
    row = evidence(coder, report.narrative, sight.upright(drawing))
    row.ids.append(coder.special[ROAD])
    assert inputs["input_ids"][0].tolist() == row.ids
    model = AutoModelForImageTextToText.from_pretrained(WEIGHTS, dtype=torch.float32)
    with torch.no_grad():
        theirs = model(**inputs).logits[0, -1]
        mine = forward.hidden(collate([row], coder))[0, -1] @ forward.model.lm_head.weight.T
    assert torch.allclose(theirs, mine, atol=2e-2)


def test_texts_of_unlike_length_and_pictures_share_a_batch(
    processor: plugins.backbone.mini.processor.MiniProcessor,
) -> None:
    white = Image.new("RGB", (200, 100), "white")
    found = processor([NARRATIVE + "<|road|>", "<|vision_start|><|image_pad|><|vision_end|><|road|>"], [white])
    assert found["input_ids"].shape == found["mm_token_type_ids"].shape
    assert int(found["mm_token_type_ids"].sum()) * 4 == len(found["pixel_values"])


def test_a_missing_picture_is_told(processor: plugins.backbone.mini.processor.MiniProcessor) -> None:
    with pytest.raises(ValueError, match=r"name 1 pictures .* 0 are given"):
        processor("<|image_pad|><|road|>")
