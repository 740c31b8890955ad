"""The closed kinds: one record each, and every place that takes them agrees with it."""

import hashlib
import json
from random import Random
from typing import get_args

import pytest

from mini import answers, tags
from mini.generator.crash import sample_crash
from sgcad_core import kinds, specs
from sgcad_core.language import rule, values


def test_literals_and_records_are_the_same() -> None:
    assert len(kinds.JUNCTIONS) == len(get_args(kinds.JunctionKind))
    assert {record.kind for record in kinds.JUNCTIONS} == set(get_args(kinds.JunctionKind))
    assert get_args(kinds.RoadKind) == kinds.ROADS == tags.ROADS
    assert get_args(kinds.Maneuver) == kinds.MANEUVERS == answers.MANEUVERS
    assert specs.Maneuver is kinds.Maneuver
    assert specs.RoadKind is kinds.RoadKind


@pytest.mark.parametrize(
    ("spec", "digest"),
    [
        (specs.RoadLayout, "59e49856b88e0257"),
        (specs.BehaviorSpec, "9a96298a9a308d6e"),
        (specs.RoadSpec, "b999140401be4731"),
    ],
)
def test_the_schemas_that_the_weights_were_trained_on_stand(spec: type[specs.Spec], digest: str) -> None:
    schema = json.dumps(specs.trained_schema(spec))
    assert hashlib.sha256(schema.encode()).hexdigest()[:16] == digest, "weights must be trained anew"


def test_made_reports_have_the_layouts_of_the_records_with_as_many_legs() -> None:
    legs = {record.layout: record.legs for record in kinds.JUNCTIONS if record.layout}
    seen = set()
    for seed in range(600):
        crash = sample_crash(Random(seed))
        seen.add(crash.layout)
        assert len(crash.legs) == legs[crash.layout], crash.layout
    assert seen == set(legs)


def test_kinds_that_a_text_names_have_wordings() -> None:
    for record in kinds.JUNCTIONS:
        if record.rule:
            assert rule(record.rule).search(f"The crash occurred at {record.called}."), record.kind


def test_every_word_for_a_place_that_cannot_be_drawn_means_a_record_and_every_record_has_a_word() -> None:
    assert set(values("unsupported_place").values()) == {record.kind for record in kinds.UNSUPPORTED}


def test_a_kind_that_there_is_not_is_an_error() -> None:
    with pytest.raises(KeyError, match="cloverleaf"):
        kinds.junction_kind("cloverleaf")  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="t"):
        kinds.unsupported_kind("t")
