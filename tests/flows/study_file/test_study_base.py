"""A study written as differences to another one, and a study's one config for all its arms."""

import pytest
import yaml

from flows.study import plan
from flows.study_file.spec import is_study, load_study
from sgcad_core import settings
from sgcad_core.errors import ConfigError

BASE = {
    "title": "T", "reference": "one", "config": "a.yaml",
    "arms": [
        {"name": "one", "label": "One", "published": "tbg", "set": {"seed": 1, "decoder": {"name": "cad"}}},
        {"name": "two", "config": "b.yaml"},
    ],
    "cross": {"over": {"decoder.alpha": [0, 0.5]}, "published": {"alpha_0": "tbg"}},
}  # fmt: skip


@pytest.fixture
def study(tmp_path):
    """Reads a study that extends BASE by these changes."""
    (tmp_path / "base.yaml").write_text(yaml.safe_dump(BASE, sort_keys=False))

    def read(**changes):
        file = tmp_path / "mine.yaml"
        file.write_text(yaml.safe_dump({"extends": "base.yaml", **changes}))
        return load_study(file)

    return read


def test_an_arm_without_a_config_takes_the_studys(study):
    assert [(arm.name, arm.config) for arm in study().arms] == [
        ("one", "a.yaml"), ("two", "b.yaml"), ("alpha_0", "a.yaml"), ("alpha_0.5", "a.yaml"),
    ]  # fmt: skip
    assert [arm.config for arm in study(config="c.yaml").arms] == ["c.yaml", "b.yaml", "c.yaml", "c.yaml"]


def test_a_study_that_names_its_arms_in_the_base_only_is_a_study(study):
    file = study().file
    assert is_study(file)
    assert study().extends == "base.yaml"
    file.write_text("extends: nothing.yaml")
    assert not is_study(file)


def test_overrides_may_be_a_mapping(study):
    assert study().arms[0].set == ("seed=1", 'decoder={"name": "cad"}')


def test_an_arm_of_the_same_name_is_changed_and_a_new_one_added(study):
    found = study(arms=[{"name": "two", "label": "Two"}, {"name": "three"}, {"name": "one", "published": None}])
    assert [(a.name, a.label, a.published, a.config) for a in found.arms[:3]] == [
        ("one", "One", None, "a.yaml"), ("two", "Two", None, "b.yaml"), ("three", "", None, "a.yaml"),
    ]  # fmt: skip
    assert found.arms[0].set == ("seed=1", 'decoder={"name": "cad"}')


def test_an_arm_changed_twice_is_told(study):
    faults = study(arms=[{"name": "one", "label": "A"}, {"name": "one", "label": "B"}]).faults
    assert any("arm 'one' stands twice" in fault for fault in faults), faults


def test_a_cross_product_is_changed_key_by_key(study):
    found = study(cross={"over": {"seed": [1, 2]}, "published": {"seed_2": "osm_direct"}})
    assert [(arm.name, arm.published) for arm in found.arms[2:]] == [("seed_1", None), ("seed_2", "osm_direct")]
    assert [arm.published for arm in study(cross={"published": None}).arms[2:]] == [None, None]


def test_a_published_row_of_no_arm_is_told(study):
    faults = study(cross={"published": {"alpha_0.4": "tbg"}}).faults
    assert any("cross.published.alpha_0.4: no arm is called so. Did you mean 'alpha_0.5'?" in f for f in faults), faults


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"extends": "nothing.yaml"}, "mine.yaml: extends 'nothing.yaml': no such file beside it or under studies/ or"),
        ({"title": None, "titel": "U"}, r"mine.yaml: 2 fault\(s\)\n  title: Field required"),
        ({"truth": None}, r"mine.yaml \(extends .*base.yaml\): 1 fault\(s\)\n  truth: null removes a key of the base"),
    ],
)
def test_a_base_that_cannot_serve_is_told(study, changes, told):
    with pytest.raises(ConfigError, match=told):
        study(**changes)


@pytest.mark.parametrize("kind", ["components", "baselines", "rag", "alpha", "robustness", "refinement"])
def test_every_study_of_the_paper_stands_on_its_set_up_with_both_backbones(kind, tmp_path):
    told = []
    for backbone in ("qwen72b", "llama90b"):
        study = load_study(f"{kind}_{backbone}")
        configs = {arm.config for arm in study.arms}
        assert configs <= {f"paper/{backbone}_sg_cadvlm.yaml", "paper/tbg.yaml"}
        told.append([(arm.name, arm.label, arm.set) for arm in study.arms])
        for arm, config in zip(study.arms, plan.arms_of(study, tmp_path), strict=True):
            model = {"qwen72b": "Qwen/Qwen2.5-VL-72B-Instruct", "llama90b": "meta-llama/Llama-3.2-90B-Vision-Instruct"}
            assert arm.config == "paper/tbg.yaml" or config.raw["backbone"]["model"] == model[backbone]
    assert told[0] == told[1]
    assert (settings.CONFIGS / "studies" / f"{kind}.yaml").is_file()
