"""Fields of a JSON answer: where they stand and what their tokens add up to."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.asking.json_field_spans import field_spans, first_tokens, grounding, is_refusal, name_of, open_path

SCALARS = st.none() | st.booleans() | st.integers(-99, 99) | st.floats(-9, 9) | st.text(max_size=8)
VALUES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("abcxyz_", min_size=1, max_size=4), inner, max_size=3)
    ),
    max_leaves=8,
)


def leaf_values(value: Any, path: str = "") -> dict[str, Any]:
    if isinstance(value, dict):
        return {k: v for key, item in value.items() for k, v in leaf_values(item, f"{path}.{key}".lstrip(".")).items()}
    if isinstance(value, list):
        return {k: v for i, item in enumerate(value) for k, v in leaf_values(item, f"{path}[{i}]").items()}
    return {path or "$": value}


@given(VALUES, st.sampled_from([None, 1]))
@settings(max_examples=150, deadline=None)
def test_every_leaf_is_found_at_its_path_with_its_text(value: Any, indent: int | None) -> None:
    text = json.dumps(value, indent=indent, ensure_ascii=False)
    found = {s.path: json.loads(text[s.start : s.end]) for s in field_spans(text) if not s.path.endswith("[]")}
    assert found == leaf_values(value)


@given(VALUES, st.integers(0, 60))
@settings(max_examples=150, deadline=None)
def test_a_text_that_breaks_off_gives_the_fields_up_to_there(value: Any, cut: int) -> None:
    text = json.dumps(value, separators=(",", ":"))
    whole, part = field_spans(text), field_spans(text[:cut])
    assert [s.path for s in part] == [s.path for s in whole][: len(part)]
    assert open_path(text[:cut])


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ('{"legs":[{"lanes_in":', "legs[0].lanes_in"),
        ('{"legs":[{"lanes_in":2', "legs[0].lanes_in"),
        ('{"legs":[{"lanes_in":2,"kind":"ro', "legs[0].kind"),
        ('{"a":1,"b":"x\\"', "b"),
        ("", "$"),
        ('"abc', "$"),
    ],
)
def test_the_open_path_names_the_field_being_written(text: str, path: str) -> None:
    assert open_path(text) == path


def test_grounding_sums_the_tokens_of_each_field_and_of_list_lengths() -> None:
    tokens = ['{"', "n", '":', "12", ',"m":[', '"a', '"', ',"b"', "]}"]
    ends, at = [], 0
    for token in tokens:
        at += len(token)
        ends.append(at)
    gains = [0.0, 0.0, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]
    found = grounding("".join(tokens), ends, gains, [0.0] * len(tokens))
    assert found == {"n": 1.0, "m[]": 2.0 + 16.0 + 32.0, "m[0]": 12.0, "m[1]": 0.0}


def test_a_token_over_several_fields_counts_to_the_first() -> None:
    assert grounding("[1,2]", [3, 5], [3.0, 5.0], [1.0, 1.0]) == {"[]": 2.0, "[0]": 0.0, "[1]": 4.0}


@given(VALUES, st.lists(st.integers(1, 5), min_size=1))
@settings(max_examples=100, deadline=None)
def test_a_field_begins_in_the_token_that_holds_its_first_letter(value: Any, sizes: list[int]) -> None:
    text = json.dumps(value, separators=(",", ":"))
    ends = [0]
    while ends[-1] < len(text):
        ends.append(ends[-1] + sizes[len(ends) % len(sizes)])
    found = first_tokens(text, ends[1:])
    firsts = {span.path: span for span in reversed(field_spans(text))}
    for span in firsts.values():
        assert ends[found[span.path]] <= span.start < ends[found[span.path] + 1]


def test_the_name_of_a_field_has_no_places() -> None:
    assert name_of("legs[0].turns_in[12]") == "legs.turns_in"
    assert name_of("legs[]") == "legs"
    assert name_of("light") == "light"


def test_a_refusal_is_an_object_with_the_key_refuse() -> None:
    assert is_refusal('{"refuse":"no layout","missing":["lanes"]}')
    assert not is_refusal('{"legs":[]}')
    assert not is_refusal('"refuse"')
    assert not is_refusal("no JSON")
