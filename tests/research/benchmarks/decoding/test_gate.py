"""The gate's calibration: thresholds from groundings, and groundings from a model, kept so that a run can go on."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.report_reader.degrade import Level
from research.benchmarks.decoding import gate
from research.benchmarks.decoding.gate_sweep import Sample, area, candidates, choose, halves, refused, score, sweep
from sgcad_core.config import load

GROUPS = ["lanes", "actors"]
LEVELS: tuple[Level, ...] = ("full", "critical_depletion", "total_sparsity")
NATS = st.floats(-20, 20)
SAMPLES = st.lists(
    st.builds(
        Sample,
        case=st.sampled_from([f"case-{i}" for i in range(12)]),
        level=st.just("full"),
        thin=st.booleans(),
        declined=st.booleans(),
        sums=st.dictionaries(st.sampled_from(GROUPS), NATS),
    ),
    max_size=25,
)


def sample(thin: bool, declined: bool = False, case: str = "c", **sums: float) -> Sample:
    return Sample(case, "full", thin, declined, sums)


def test_two_groups_that_only_together_tell_thin_from_enough_are_both_chosen() -> None:
    samples = [
        sample(True, lanes=0.1, actors=9.0), sample(True, lanes=8.0, actors=0.2),
        *(sample(False, lanes=5.0 + i, actors=4.0 + i) for i in range(4)),
    ]  # fmt: skip
    chosen = choose(samples, GROUPS)
    assert None not in chosen.values()
    assert score(samples, refused(samples, chosen)).f1 == 1.0


def test_a_group_that_tells_nothing_is_left_out() -> None:
    samples = [sample(i % 2 == 0, lanes=float(i % 2), actors=float(i % 3)) for i in range(12)]
    assert choose(samples, GROUPS) == {"lanes": 0.5, "actors": None}


@settings(deadline=None)
@given(SAMPLES)
def test_the_choice_is_never_worse_than_the_model_alone(samples: list[Sample]) -> None:
    chosen = choose(samples, GROUPS)
    assert score(samples, refused(samples, chosen)).f1 >= score(samples, refused(samples, {})).f1


@settings(deadline=None)
@given(SAMPLES, st.floats(0.3, 1.0))
def test_a_stated_precision_is_kept_where_the_model_keeps_it(samples: list[Sample], precision: float) -> None:
    if score(samples, refused(samples, {})).precision >= precision:
        assert score(samples, refused(samples, choose(samples, GROUPS, precision))).precision >= precision


@settings(deadline=None)
@given(SAMPLES)
def test_a_higher_threshold_never_refuses_less(samples: list[Sample]) -> None:
    given_ = [s.given for _, s in sweep(samples, "lanes")]
    assert given_ == sorted(given_)
    assert all(s.right <= min(s.given, s.wanted) for _, s in sweep(samples, "lanes"))


@settings(deadline=None)
@given(SAMPLES)
def test_the_area_is_the_same_on_any_rising_scale(samples: list[Sample]) -> None:
    scaled = [sample(s.thin, **{k: 8 * v for k, v in s.sums.items()}) for s in samples]
    assert area(samples, "lanes") == pytest.approx(area(scaled, "lanes"), nan_ok=True)


def test_the_area_is_one_if_every_thin_report_has_less_and_a_half_if_all_are_equal() -> None:
    assert area([sample(True, lanes=1.0), sample(False, lanes=2.0)], "lanes") == 1.0
    assert area([sample(True, lanes=2.0), sample(False, lanes=2.0)], "lanes") == 0.5
    assert candidates([sample(True, lanes=2.0)], "lanes") == []


@settings(deadline=None)
@given(SAMPLES)
def test_a_report_stands_in_one_half_with_all_its_levels(samples: list[Sample]) -> None:
    fit, test = halves(samples)
    assert len(fit) + len(test) == len(samples)
    assert not {s.case for s in fit} & {s.case for s in test}


def test_a_refusal_of_the_model_counts_only_where_it_is_asked_for() -> None:
    samples = [sample(True, declined=True), sample(False, lanes=3.0)]
    assert refused(samples, {}).tolist() == [True, False]
    assert refused(samples, {"lanes": 4.0}, model=False).tolist() == [False, True]
    found = score(samples, refused(samples, {"lanes": 4.0}))
    assert (found.precision, found.recall, found.false_alarms) == (0.5, 1.0, 1.0)


def test_the_tables_name_the_choice_as_it_stands_in_a_config(tmp_path: Path) -> None:
    samples = [
        Sample(f"case-{i}", level, level in gate.THIN, False, dict.fromkeys(gate.NAMES, 1.0 + 4 * (level == "full")))
        for i in range(12)
        for level in ("full", "total_sparsity")
    ]
    text = gate.report(samples, None)
    assert "{name: evidence_gate, road_layout: 3.0, lanes: null, actors: null, first_contact: null}" in text
    assert "| both | held out | 1.00 | 1.00 | 1.00 | 0.00 |" in text
    assert "| total_sparsity | refusal |" in text
    with pytest.raises(SystemExit, match="too few for two halves"):
        gate.report(samples[:2], None)


def test_another_decoder_or_other_weights_keep_their_groundings_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text("{}", encoding="utf-8")
    told = (), ("decoder.scale=0.3",), (f"backbone.model={tmp_path}",)
    files = [gate.default_file(load("mini.yaml", overrides)) for overrides in told]
    (tmp_path / "config.json").write_text("{ }", encoding="utf-8")
    files.append(gate.default_file(load("mini.yaml", told[-1])))
    assert len(set(files)) == len(files)
    assert files[0] == gate.default_file(load("mini.yaml"))


def test_the_embedded_model_gives_groundings_that_are_kept_and_not_asked_again(tmp_path: Path) -> None:
    file = tmp_path / "gate.jsonl"
    reports = list(gate.made(1))
    first = gate.collected(load("mini.yaml"), iter(reports), file, 2, LEVELS)
    assert {s.level for s in first} == set(LEVELS)
    full = next(s for s in first if s.level == "full")
    assert full.declined or {"road_layout", "lanes"} <= set(full.sums)
    assert {s.level for s in first if s.thin} == {"critical_depletion", "total_sparsity"}
    lines = file.read_text(encoding="utf-8").splitlines()
    file.write_text("\n".join([*lines[:-1], lines[-1][:9]]) + "\n", encoding="utf-8")
    assert len(gate.kept(file)) == len(LEVELS) - 1
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    elsewhere = load("mini.yaml", ("backbone.model=no/such/model",))
    assert {(s.level, s.declined) for s in gate.collected(elsewhere, iter(reports), file, 2, LEVELS)} == {
        (s.level, s.declined) for s in first
    }
