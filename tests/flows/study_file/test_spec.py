"""A study file: lists, cross products, and every fault of it told at once."""

from pathlib import Path

import pytest

from flows.study_file.spec import load_study, study_in
from sgcad_core import settings
from sgcad_core.errors import ConfigError


@pytest.fixture
def study(tmp_path):
    """Reads a study of this text."""

    def read(text):
        file = tmp_path / "mine.yaml"
        file.write_text(text)
        return load_study(file)

    return read


def test_listed_arms_come_before_crossed_ones(study):
    read = study(
        "title: T\n"
        "arms: [{name: one, config: a.yaml, set: [seed=3]}]\n"
        "cross: {config: b.yaml, set: [max_attempts=2], over: {decoder.alpha: [0, 0.5], seed: [1, 2]}}\n"
    )
    assert [arm.name for arm in read.arms] == [
        "one", "alpha_0-seed_1", "alpha_0-seed_2", "alpha_0.5-seed_1", "alpha_0.5-seed_2",
    ]  # fmt: skip
    assert read.arms[-1].set == ("max_attempts=2", "decoder.alpha=0.5", "seed=2")
    assert read.arms[-1].factors == {"decoder.alpha": 0.5, "seed": 2}
    assert read.faults == ()
    assert read.name == "mine"


def test_the_config_itself_can_be_crossed(study):
    read = study("title: T\ncross: {over: {config: [a.yaml, b.yaml], seed: [1]}}")
    assert [(arm.name, arm.config, arm.set) for arm in read.arms] == [
        ("a-seed_1", "a.yaml", ("seed=1",)), ("b-seed_1", "b.yaml", ("seed=1",)),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("title: T\ntytle: U\narms: [{name: a, config: a.yaml}]", "tytle: unknown key. Did you mean 'title'? K"),
        ("title: T\narms: [{name: a, config: a.yaml, sets: []}]", "arms.0.sets: unknown key. Did you mean 'set'? K"),
        ("title: T\ncross: {config: a.yaml, over: {seed: [1]}, all: 1}", "cross.all: unknown key. Known: config, over"),
        ("title: T\narms: [{name: a, config: a.yaml}, {name: A, config: b.yaml}]", "arm 'a' stands twice"),
        ("title: T\ncross: {config: a.yaml, over: {seed: [1, 1]}}", "arm 'seed_1' stands twice"),
        ("title: T\narms: [{name: a/b, config: a.yaml}]", "arm 'a/b' cannot be a folder's name; such as 'a_b' can"),
        ("title: T\narms: [{name: .stages, config: a.yaml}]", "arm '.stages' cannot be a folder's name"),
        ("title: T\narms: [{name: --x, config: a.yaml}]", "arm '--x' cannot be a folder's name; such as 'x' can"),
        ("title: T", "no arm: give `arms`"),
        ("title: T\ncross: {config: a.yaml, over: {seed: []}}", "cross.over.seed: no values"),
        ("title: T\nreference: b\narms: [{name: a, config: a.yaml}]", "reference: no arm is called 'b'; there are: a"),
    ],
)  # fmt: skip
def test_a_fault_is_told_and_the_rest_is_still_read(study, text, told):
    faults = study(text).faults
    assert any(told in fault for fault in faults), faults


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("arms: [{name: a, config: a.yaml}]", "title: Field required"),
        ("title: T\narms: [{config: a.yaml}]", r"arms\.0\.name: Field required"),
        ("title: T\ncross: {config: a.yaml}", r"cross\.over: Field required"),
        ("title: T\ncross: {over: {seed: [1]}}", "cross: Value error, config: missing"),
        (
            "title: T\ncross: {config: a, over: {a: &x [0, 1, 2, 3, 4, 5, 6, 7, 8, 9], "
            + ", ".join(f"{k}: *x" for k in "bcdefghijkl")
            + "}}",
            "1000000000000 arms; at most 500",
        ),
        ("title: T\narms: [[", "cannot be read as YAML"),
        ("- a\n- b", "expected a mapping with `title`"),
    ],
)
def test_what_cannot_be_read_at_all_is_refused(study, text, told):
    with pytest.raises(ConfigError, match=told):
        study(text)


def test_a_study_is_found_by_its_name():
    assert load_study("alpha").file == settings.CONFIGS / "studies" / "alpha.yaml"
    with pytest.raises(ConfigError, match=r"no such study. In configs/studies/: alpha, .*robustness"):
        load_study("no-such-study")


def test_studies_and_configs_are_told_apart():
    assert study_in(settings.CONFIGS / "rag.yaml") is None
    assert study_in(settings.CONFIGS / "studies" / "rag.yaml")
    assert study_in(Path("template.yaml")) is None
    assert study_in(Path("alpha")) == settings.CONFIGS / "studies" / "alpha.yaml"
