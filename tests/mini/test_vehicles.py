"""What the generator calls vehicles means the same to the reader."""

import pytest

from mini.generator.vehicles import BODIES, COLORS, MODELS
from sgcad_core.language import values, words

PLAIN = {"4-door", "four-door", "two-door", "2-door utility"}
"""Door counts, which name no kind by themselves."""
NAMES = [(kind, name) for kind, listed in BODIES.items() for name in sorted(set(listed.split("|")) - PLAIN)]


@pytest.mark.parametrize(("kind", "name"), NAMES, ids=lambda part: part.replace(" ", "_"))
def test_a_body_is_of_one_kind_for_both(kind: str, name: str) -> None:
    known = {word: meaning for word, meaning in values("body").items() if word in name.lower()}
    assert known, f"{name!r} is in no body word of sgcad_core/language/vocabulary/vehicles.yaml"
    assert known[max(known, key=len)] == kind


def test_colors_are_words_of_the_vocabulary() -> None:
    assert set(COLORS) <= set(words("color"))


@pytest.mark.parametrize("kind", sorted(set(MODELS) - {"bus"}))  # who builds buses builds trucks too
def test_a_make_that_builds_one_kind_builds_that_kind(kind: str) -> None:
    makes = {word: make for word, make in values("make").items() if isinstance(make, dict)}
    wrong = {
        model: makes[word]["kind"]
        for model in MODELS[kind]
        for word in makes
        if model.lower().startswith(word) and makes[word]["kind"] != kind
    }
    assert wrong == {}
