"""The gist of a crash: one walk with the spec's own JSON, sets of values as labels, rows that know a part."""

import json
import math
from pathlib import Path
from random import Random

import pytest
import torch

from research.generator.incidents import AT_JUNCTION, SITUATIONS, make_incident
from research.generator.report import make_report
from research.model import answer_grammar
from research.model.batch import Batch
from research.model.tokens import ROAD, SCENARIO, Coder, load_tokenizer
from research.rows.collate import collate
from research.rows.gist_rows import gist_row, gist_walk, told_of
from research.rows.partial_labels import OPTIONS, Told, load
from research.rows.row_stream import one_row
from sgcad_core import settings
from sgcad_core.asking.prompts import load_prompt
from sgcad_core.reading.second_reader.seven_question_gist import FIELDS, Gist
from sgcad_core.records.answer_schema import trained_schema

WEIGHTS = settings.ROOT / "plugins" / "backbone" / "mini" / "weights"
KNOWN = {"touched": (True,), "subject": ("stopped",), "subject_area": ("back", "left")}


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(load_tokenizer(WEIGHTS))


def test_the_walk_writes_what_the_spec_writes() -> None:
    gist = Gist(
        touched=False, met="suv", subject="straight", other="turn_left", subject_area="front", other_area="right",
        junction=True,
    )  # fmt: skip
    written = answer_grammar.write(gist_walk(), json.loads(gist.model_dump_json()))
    assert "".join(text for text, _ in written) == gist.model_dump_json()
    assert tuple(OPTIONS) == FIELDS


def test_every_option_of_the_walk_is_one_of_the_schema_and_one_token(coder: Coder) -> None:
    schema = trained_schema(Gist)["properties"]
    for key, options in OPTIONS.items():
        assert all(len(coder.piece(text)) == 1 for text in options)
        named = schema[key].get("enum")
        assert named is None or {json.dumps(value) for value in named} == set(options)


def test_the_prompt_of_the_config_is_the_question_that_trains(coder: Coder) -> None:
    row = gist_row(coder, Told("a", "The AV stopped.", {}), Random(0))
    asked = [coder.special[ROAD], coder.special[SCENARIO]]
    begun = len(coder.text("The AV stopped."))
    assert row.ids[begun : begun + 2] == asked
    encoded = coder.raw.encode(load_prompt("mini_gist"), add_special_tokens=False).ids
    assert encoded == asked


def test_a_row_asks_only_for_what_is_known(coder: Coder) -> None:
    row = gist_row(coder, Told("a", "The AV was stopped.", KNOWN, {"touched": 0.5}), Random(0))
    assert sorted(weight for _, weight in row.picks) == [0.5, 1.0, 1.0]
    places = [place for place, _ in row.picks]
    assert row.also[places[2]] == [coder.piece('"back"')[0], coder.piece('"left"')[0]]
    assert row.ids[places[2]] in row.also[places[2]], "what is read on the way is one of those allowed"


def test_a_set_of_values_is_as_right_as_all_of_them_together(coder: Coder) -> None:
    from plugins.backbone.mini.patch_convnet import Eye
    from research.model.model import Forward, make_config, make_model

    torch.manual_seed(0)
    forward = Forward(make_model(make_config(len(coder.tokenizer), coder.special, "tiny")).eval(), Eye().eval())
    row = gist_row(coder, Told("a", "The AV was stopped.", {"subject_area": ("back", "left")}), Random(0))
    batch: Batch = collate([row], coder)
    with torch.no_grad():
        loss, _ = forward.loss(batch)
        state = forward.hidden(batch).view(-1, forward.model.config.text_config.hidden_size)[batch.picks]
        shares = (state @ forward.model.lm_head.weight.T).softmax(-1)[0]
    both = sum(float(shares[coder.piece(text)[0]]) for text in ('"back"', '"left"'))
    assert float(loss) == pytest.approx(-math.log(both), abs=1e-4)


def test_rows_are_read_from_a_file_and_faults_name_the_line(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_text(json.dumps({"id": "a", "text": "x", "allowed": {"met": ["car", "suv"]}}) + "\n")
    assert load(file) == [Told("a", "x", {"met": ("car", "suv")})]
    for line, message in (
        ('{"id": "a"}', "line 1: no row"),
        ('{"id": "a", "text": "x", "allowed": {"mett": ["car"]}}', "'mett' is no field; use touched"),
        ('{"id": "a", "text": "x", "allowed": {"met": ["boat"]}}', r"met allows \['boat'\]; use some of"),
        ('{"id": "a", "text": "x", "allowed": {"met": []}}', "met allows nothing"),
    ):
        file.write_text(line)
        with pytest.raises(ValueError, match=message):
            load(file)


def test_a_made_report_tells_the_gist_of_its_answer() -> None:
    for seed in range(40):
        report = make_report(seed, modes={"text": 1.0})
        told = told_of(report)
        if told is None:
            continue
        assert report.behavior is not None
        contact = report.behavior["contacts"][0]
        mine = "striker" if contact["striker"] == "V1" else "struck"
        assert told.allowed["subject_area"] == (contact[f"{mine}_area"],)
        by_id = {actor["id"]: actor for actor in report.behavior["actors"]}
        assert told.allowed["subject"] == (by_id["V1"]["maneuver"],)


def test_made_incidents_are_of_every_situation_and_their_labels_are_allowed() -> None:
    made = [make_incident(seed) for seed in range(600)]
    assert {"stopped", "parked", "backing"} <= {told.allowed["subject"][0] for told in made}
    assert {False, True} == {told.allowed["touched"][0] for told in made}
    assert {s.other for s in SITUATIONS if s.met == "vehicle"} <= {
        told.allowed["other"][0] for told in made if "other" in told.allowed
    }
    for told in made:
        assert all(json.dumps(value) in OPTIONS[key] for key, some in told.allowed.items() for value in some)
        assert told.allowed["junction"] == (bool(AT_JUNCTION.search(told.text)),)
        assert not any(rest in told.text for rest in ("{", "[|", "  "))


def test_a_seed_gives_one_row_and_told_texts_have_their_share(coder: Coder) -> None:
    told = [Told("a", "The AV was stopped at a light and an SUV hit its rear.", KNOWN)]
    rows = [one_row(coder, seed, 0.5, "gist", told) for seed in range(12)]
    again = [one_row(coder, seed, 0.5, "gist", told) for seed in range(12)]
    assert [row.ids for row in rows] == [row.ids for row in again]
    assert any(coder.special[ROAD] in row.ids for row in rows)
