"""A config is checked whole, and every fault names its key, its value and the remedy."""

import pytest
import yaml

from sgcad_core import config, settings
from sgcad_core.errors import ConfigError

BASE = {
    "report_reader": "auto", "retriever": "none", "road_writer": "template", "scenario_writer": "rules",
    "validators": ["sumo_xsd", {"name": "topology"}], "simulator": "kinematic", "tracker": "none",
}  # fmt: skip


def build(**changes):
    raw = {**BASE, **changes}
    return config.build({k: v for k, v in raw.items() if v is not ...}, "test", "test.yaml")


def test_a_plain_name_is_a_plugin_with_its_defaults():
    built = build()
    assert built.road_writer.kind == "road_writer"
    assert [v.stage for v in built.validators] == ["road", "road"]
    assert built.max_attempts == 10


def test_validators_are_told_apart_by_stage():
    built = build(validators=["openscenario", "topology", "agreement"])
    assert [type(v).__name__ for v in built.validators_of("scenario")] == ["OpenScenario", "Agreement"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"simulatr": "kinematic"}, r"simulatr: unknown key. Did you mean 'simulator'\? Known: .*seed"),
        ({"simulator": ...}, r"simulator: missing; give it a `name`"),
        ({"simulator": "kinematik"}, r"simulator: unknown simulator 'kinematik'. Did you mean 'kinematic'\?"),
        ({"simulator": {"name": "kinematic", "speed": 3}}, r"simulator.speed: unknown field. Known: none \(found 3\)"),
        (
            {"report_reader": {"name": "auto", "use_diagram": False}},
            r"report_reader.use_diagram: unknown field. Did you mean 'use_diagrams'\? Known: .*use_coded_fields",
        ),
        (
            {"decoder": "cad"},
            r"decoder: 'cad' would decode nothing: road_writer 'template' and scenario_writer 'rules' ask no model",
        ),
        ({"decoder": {"name": "cad", "alpha": "much"}}, r"decoder.alpha: .*valid number.* \(found 'much'\)"),
        ({"validators": "topology"}, r"validators: expected a list, found 'topology'"),
        ({"validators": [{"nam": "x"}]}, r"validators\[0\]: expected a mapping with a `name`"),
        ({"traffic": "heavy", "simulator": "libsumo"}, r"traffic: .*'none', 'light' or 'dense' \(found 'heavy'\)"),
        (
            {"traffic": "light"},
            r"traffic: simulator 'kinematic' drives no traffic; take simulator 'libsumo', or traffic: none",
        ),
        ({"max_attempts": 11}, r"max_attempts: .*less than or equal to 10 \(found 11\)"),
        ({"seed": -1}, r"seed: .*greater than or equal to 0"),
        ({"road_writer": "spec"}, r"backbone: missing, but road_writer ask a model"),
        (
            {"road_writer": "spec", "decoder": "cad", "backbone": {"name": "openai_chat", "model": "m"}},
            r"decoder 'cad' needs logits; backbone 'openai_chat' gives none; use decoder 'greedy'",
        ),
    ],
    ids=lambda v: next(iter(v)) if isinstance(v, dict) else None,
)
def test_a_fault_is_named_before_anything_starts(changes, message):
    with pytest.raises(ConfigError, match=message):
        build(**changes)


def test_all_faults_come_at_once():
    with pytest.raises(ConfigError, match=r"3 fault\(s\)"):
        build(simulatr=1, tracker="nowhere", simulator={"name": "kinematic", "x": 1})


def test_overrides_reach_into_plugins(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text(yaml.safe_dump(BASE))
    loaded = config.load(file, ("simulator=libsumo", "max_attempts=3", "report_reader.use_diagrams=false"))
    assert type(loaded.simulator).__name__ == "LibSumo"
    assert loaded.max_attempts == 3
    assert loaded.report_reader.use_diagrams is False


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("alpha", r"--set 'alpha': expected key=value, such as decoder.alpha=0.3"),
        ("=3", "expected key=value"),
        ("seed.x=3", "'seed' is no mapping"),
        ("seed=[", "the value is no YAML"),
    ],
)
def test_an_override_that_cannot_be_read_is_named(tmp_path, text, message):
    file = tmp_path / "a.yaml"
    file.write_text(yaml.safe_dump({**BASE, "seed": 1}))
    with pytest.raises(ConfigError, match=message):
        config.load(file, (text,))


@pytest.mark.parametrize(
    ("content", "message"), [("a: [", "cannot be read as YAML"), ("- 1", "found list"), ("", "found NoneType")]
)
def test_a_file_that_is_no_mapping_is_named(tmp_path, content, message):
    file = tmp_path / "a.yaml"
    file.write_text(content)
    with pytest.raises(ConfigError, match=message):
        config.load(file)


def test_an_unknown_file_lists_the_known_ones():
    with pytest.raises(ConfigError, match=r"nowhere.yaml: no such config. In configs/: .*template.yaml"):
        config.load("nowhere.yaml")


@pytest.mark.parametrize("slip", ["templat.yaml", "Template", "tempalte"])
def test_a_slip_of_the_pen_in_a_files_name_is_answered_with_the_nearest_one(slip):
    with pytest.raises(ConfigError, match=rf"{slip}: no such config. Did you mean 'template'\?"):
        config.load(slip)


def test_a_fault_speaks_of_yaml_and_not_of_python():
    with pytest.raises(ConfigError) as told:
        build(road_writer={"name": "template", "junction": 3}, report_reader={"name": "auto", "use_diagrams": {}})
    for word in ("Template", "Auto", "instance of", "pydantic", "Extra inputs"):
        assert word not in str(told.value)


def test_a_config_is_named_by_its_path_under_configs(tmp_path):
    assert config.name_of(settings.CONFIGS / "paper" / "base_vlm.yaml") == "paper-base_vlm"
    assert config.name_of(tmp_path / "mine.yaml") == "mine"
