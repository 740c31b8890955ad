"""Cross products: how many arms, and that each has a folder's name and overrides that say what it is."""

import yaml
from hypothesis import given
from hypothesis import strategies as st

from flows.case_files.find_cases import safe_id
from flows.study_file import cross_product

VALUES = st.one_of(st.booleans(), st.integers(-9, 9), st.floats(0, 2), st.text("abc/ :{}=é", max_size=8), st.none())
OVER = st.dictionaries(
    st.from_regex(r"[a-z]{1,8}\.[a-z]{1,8}", fullmatch=True),
    st.lists(VALUES, min_size=1, max_size=3),
    min_size=1,
    max_size=3,
)


@given(OVER)
def test_every_combination_is_there_once(over):
    made = list(cross_product.combinations(over))
    count = 1
    for values in over.values():
        count *= len(values)
    assert len(made) == count
    assert all(made[0][key] == values[0] for key, values in over.items())


@given(OVER)
def test_a_name_is_a_folder_name(over):
    for factors in cross_product.combinations(over):
        name = cross_product.name_of(factors)
        assert name == safe_id(name)


@given(OVER)
def test_an_override_is_read_back_as_the_value(over):
    for factors in cross_product.combinations(over):
        for text, (key, value) in zip(cross_product.overrides_of(factors), factors.items(), strict=True):
            found_key, _, found = text.partition("=")
            assert found_key == key
            read = yaml.safe_load(found)
            assert (float(read) if isinstance(value, float) else read) == value


def test_names_say_the_values():
    assert cross_product.name_of({"decoder.alpha": 0.7, "seed": 1}) == "alpha_0.7-seed_1"
    assert (
        cross_product.name_of({"config": "paper/tbg.yaml", "report_reader.use_diagrams": False})
        == "paper-tbg-use_diagrams_false"
    )
    assert cross_product.name_of({"decoder": {"name": "cad", "alpha": 0.5}}) == "cad_alpha_0.5"
    assert cross_product.label_of({"decoder.alpha": 0.7, "report_reader.level": "blur_weak"}) == "alpha 0.7, blur weak"


def test_the_config_is_no_override():
    assert cross_product.overrides_of({"config": "a.yaml", "seed": 1}) == ("seed=1",)
