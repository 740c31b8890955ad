"""A YAML written as differences: how blocks merge, and what is told of a base that cannot serve."""

import copy

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core import config, config_extends, settings
from sgcad_core.errors import ConfigError

BASE = {
    "seed": 1, "report_reader": "auto", "retriever": "none", "road_writer": {"name": "template", "leg_length_m": 180},
    "scenario_writer": "rules", "validators": ["sumo_xsd", {"name": "topology"}], "simulator": "kinematic",
    "tracker": "none",
}  # fmt: skip
KEYS = st.sampled_from(["a", "b", "c", "d"])
VALUES = st.one_of(st.integers(), st.sampled_from(["cad", "greedy"]), st.lists(st.integers(), max_size=2))
BLOCKS = st.one_of(
    st.dictionaries(KEYS, VALUES, max_size=3),
    st.builds(
        lambda name, rest: {"name": name, **rest}, st.sampled_from(["cad", "greedy"]), st.dictionaries(KEYS, VALUES)
    ),
)
WHOLES = st.dictionaries(KEYS, st.one_of(VALUES, BLOCKS), max_size=4)
CHANGES = st.dictionaries(KEYS, st.one_of(VALUES, BLOCKS, st.none()), max_size=4)


@pytest.fixture
def write(tmp_path):
    """Writes a YAML: `write("a", {...})` gives its file."""

    def one(name, content):
        file = tmp_path / f"{name}.yaml"
        file.write_text(content if isinstance(content, str) else yaml.safe_dump(content, sort_keys=False))
        return file

    return one


@pytest.fixture
def loaded(write):
    """Loads a config that extends BASE by these changes."""
    write("base", BASE)

    def one(overrides=(), **changes):
        return config.load(write("mine", {"extends": "base.yaml", **changes}), overrides)

    return one


# ------------------------------------------------------------------ merging, whatever is given
@given(WHOLES)
def test_no_change_is_the_base_itself(base):
    assert config_extends.merged(base, {}) == base


@given(WHOLES, CHANGES)
def test_keys_are_the_bases_and_the_changes_without_the_removed_ones(base, changes):
    removed = {key for key, value in changes.items() if value is None}
    assert set(config_extends.merged(base, changes)) == ({*base, *changes} - removed)


@given(WHOLES, CHANGES)
def test_a_key_that_is_not_changed_stays(base, changes):
    found = config_extends.merged(base, changes)
    assert all(found[key] == base[key] for key in base if key not in changes)


@given(WHOLES, CHANGES)
def test_words_numbers_and_lists_take_the_bases_place(base, changes):
    found = config_extends.merged(base, changes)
    assert all(found[k] == v for k, v in changes.items() if v is not None and not isinstance(v, dict))


@given(WHOLES, CHANGES)
def test_every_field_given_holds_and_a_fields_neighbors_stay_only_under_the_same_plugin(base, changes):
    for key, given_ in changes.items():
        if not isinstance(given_, dict):
            continue
        held = config_extends.named(base.get(key))
        same = isinstance(held, dict) and given_.get("name", held.get("name")) == held.get("name")
        assert config_extends.merged(base, changes)[key] == ({**held, **given_} if same else given_)


@given(WHOLES, CHANGES)
def test_the_same_changes_twice_are_the_changes_once(base, changes):
    once = config_extends.merged(base, changes)
    assert config_extends.merged(once, changes) == once


@given(WHOLES, CHANGES)
def test_neither_side_is_changed(base, changes):
    before = copy.deepcopy((base, changes))
    config_extends.merged(base, changes)
    assert (base, changes) == before


# ------------------------------------------------------------------ of a config
def test_a_mapping_changes_the_bases_fields_and_leaves_the_others(loaded):
    assert loaded(road_writer={"lanes_each_way": 2}).raw["road_writer"] == {
        "name": "template", "leg_length_m": 180, "lanes_each_way": 2,
    }  # fmt: skip


def test_a_mapping_on_a_plain_name_keeps_the_plugin(loaded):
    assert loaded(report_reader={"use_diagrams": False}).raw["report_reader"] == {"name": "auto", "use_diagrams": False}


def test_another_plugin_forgets_the_bases_fields(loaded):
    assert loaded(road_writer={"name": "map_library"}).raw["road_writer"] == {"name": "map_library"}
    assert loaded(road_writer="template").raw["road_writer"] == "template"


def test_a_null_removes_a_key_or_a_field(loaded):
    found = loaded(seed=None, road_writer={"leg_length_m": None})
    assert found.seed == 42
    assert found.raw["road_writer"] == {"name": "template"}
    assert "seed" not in found.raw


def test_overrides_come_after_the_differences(loaded):
    found = loaded(("seed=3", "road_writer.lanes_each_way=3"), seed=2, road_writer={"lanes_each_way": 2})
    assert found.seed == 3
    assert found.raw["road_writer"] == {"name": "template", "leg_length_m": 180, "lanes_each_way": 3}


def test_what_is_kept_is_the_whole(loaded):
    found = loaded(seed=2)
    assert found.raw == BASE | {"seed": 2}
    assert found.extends == "base.yaml"


def test_a_base_lies_beside_the_file_or_under_configs(write, tmp_path):
    file = write("mine", "extends: template.yaml\nseed: 7")
    assert config.load(file).raw == config.load("template.yaml").raw | {"seed": 7}
    write("template", BASE)
    assert config.load(file).raw == BASE | {"seed": 7}
    (tmp_path / "inner").mkdir()
    assert config.load(write("inner/two", "extends: ../template.yaml")).seed == 1


# ------------------------------------------------------------------ faults
@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("extends: bse.yaml", r"mine.yaml: extends 'bse.yaml': no such file beside it or under configs/.* template"),
        ("extends: tmplate.yaml", r"mine.yaml: extends 'tmplate.yaml': .* Did you mean 'template.yaml'\?"),
        ("extends: [base.yaml]", r"mine.yaml: extends: expected the name of one YAML, .*found \['base.yaml'\]"),
        ("extends:", "extends: expected the name of one YAML, .*found None"),
        ("extends: mine.yaml", "mine.yaml: extends itself: name another YAML"),
        (
            "extends: further.yaml",
            r"mine.yaml: extends .*further.yaml, which itself extends 'base.yaml': .*extend base.yaml",
        ),
        ("extends: back.yaml", r"mine.yaml: extends .*back.yaml, which extends mine.yaml in turn: a circle; write one"),
        ("extends: broken.yaml", r"mine.yaml: extends .*broken.yaml: cannot be read as YAML"),
        ("extends: list.yaml", r"mine.yaml: extends .*list.yaml: expected a mapping of plugin kinds, found list"),
        ("extends: base.yaml\nsede: 1", r"mine.yaml \(extends .*base.yaml\): 1 .*\n  sede: unknown key.*'seed'"),
        (
            "extends: base.yaml\nsede: null",
            r"mine.yaml \(extends .*base.yaml\): 1 .*\n  sede: null removes .* Did you mean 'seed'",
        ),
        (
            "extends: base.yaml\nroad_writer: {leg_lenth_m: null}",
            r"base.yaml\): 1 .*\n  road_writer.leg_lenth_m: null removes .*'leg_length_m'\? The base has: name, leg_",
        ),
        (
            "extends: base.yaml\nroad_writer: {leg_lenth_m: 3}",
            r"mine.yaml \(extends .*base.yaml\): 1 .*\n  road_writer.leg_lenth_m: unknown field. .*'leg_length_m'",
        ),
        ("extends: base.yaml\nsimulator: null", r"base.yaml\): 1 fault\(s\)\n  simulator: missing; give it a `name`"),
        ("extendz: base.yaml", r"extendz: unknown key. Did you mean 'extends'\?"),
    ],
)  # fmt: skip
def test_a_fault_names_both_files_the_key_and_the_remedy(write, content, told):
    write("base", BASE)
    write("further", "extends: base.yaml")
    write("back", "extends: mine.yaml")
    write("broken", "a: [")
    write("list", "- 1")
    with pytest.raises(ConfigError, match=told):
        config.load(write("mine", content))


def test_a_base_cannot_be_set(write):
    with pytest.raises(ConfigError, match="extends: names a base in a YAML only"):
        config.load(write("base", BASE), ("extends=template.yaml",))


# ------------------------------------------------------------------ the configs that come with the project
SHIPPED = sorted({*settings.CONFIGS.rglob("*.yaml")} - {*settings.CONFIGS.glob("studies/*.yaml")})


@pytest.mark.parametrize("file", SHIPPED, ids=lambda f: f.stem)
def test_a_config_written_out_is_the_same_config(file, tmp_path):
    found = config.load(file)
    whole = tmp_path / file.name
    whole.write_text(yaml.safe_dump(found.raw))
    again = config.load(whole)
    assert again.raw == found.raw
    assert again.model_dump(exclude={"name", "extends"}) == found.model_dump(exclude={"name", "extends"})
