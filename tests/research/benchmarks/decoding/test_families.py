"""The table of vision-language families: tiny random weights of transformers' own classes, and refusals by name."""

import pytest

from plugins.backbone.hf_vision import HfVision
from plugins.decoder.greedy import Greedy
from research.benchmarks.decoding.families import CHECKS, Row, context, row_of, table
from research.benchmarks.decoding.family_models import FAMILIES, save
from sgcad_core.case.records import Query
from sgcad_core.errors import ConfigError
from sgcad_core.settings import ROOT

REFUSED = {
    "Qwen3.5": "linear_attention",
    "Gemma 3n": "keys and values of other layers",
    "Gemma 4": "keys and values of other layers",
    "Llama 4": "chunked_attention",
    "PaliGemma": "in both directions",
    "Command A Vision": "torchvision only",
    "Phi-4-multimodal": "no image-text-to-text model of type phi4_multimodal",
    "Kimi-VL (K2.5)": "torchvision only",
    "Molmo 2": "torchvision only",
}
QUICK = ("Gemma 3", "Pixtral")
"""Run with every change: pictures seen whole and sliding layers, rows of a picture with breaks."""
BY_NAME = {family.name: family for family in FAMILIES}


def test_twenty_families_stand_beside_those_that_are_refused():
    assert len(FAMILIES) - len(REFUSED) >= 20
    assert len(BY_NAME) == len(FAMILIES)
    assert set(REFUSED) <= set(BY_NAME)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[] if n in QUICK else [pytest.mark.slow]) for n in BY_NAME if n not in REFUSED]
)
def test_a_family_passes_every_check(name):
    row = row_of(BY_NAME[name])
    assert row.held == set(CHECKS), row.line()


@pytest.mark.parametrize(("name", "why"), REFUSED.items())
def test_a_family_is_refused_by_name_before_weights_are_read(name, why, tmp_path):
    folder = save(BY_NAME[name], tmp_path)
    assert not list(folder.glob("*.safetensors"))
    backbone = HfVision(model=str(folder), device="cpu", dtype="float32")
    with pytest.raises(ConfigError, match=why):
        backbone.generate(context(0), Query(task="Tell."), Greedy())


def test_the_table_in_the_docs_has_every_family_and_its_result():
    told = (ROOT / "docs" / "families.md").read_text(encoding="utf-8")
    for family in FAMILIES:
        (line,) = [line for line in told.splitlines() if line.startswith(f"| {family.name} |")]
        assert (REFUSED[family.name] in line) if family.name in REFUSED else line.endswith("| passes |")


def test_the_table_counts_what_passes_and_what_is_refused():
    rows = [Row(FAMILIES[0], frozenset(CHECKS)), Row(FAMILIES[1], frozenset(CHECKS[1:])), Row(FAMILIES[2], refused="x")]
    assert table(rows).endswith("1 of 3 families pass, 1 are refused by name.")
    assert "**does not pass**" in table(rows)
