"""The data files: rules read their examples, words mean what they are told to mean, faults say where they are."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from sgcad_core.errors import ConfigError
from sgcad_core.reading.language import data, of_role, rule, values, words
from sgcad_core.reading.language.data import Language, language
from sgcad_core.reading.language.records import RuleRecord, rule_record, word_class
from sgcad_core.reading.reading import read
from tests.sgcad_core.reading.language.examples import class_faults, faults, parsed, reads, rule_faults, written
from tests.sgcad_core.reading.language.readings import (
    ROOT,
    asked_for,
    classes_asked_for,
    facts_of_sentences,
    reading_faults,
    roles_asked_for,
    sentences,
)

READERS = (ROOT / "sgcad_core/reading", ROOT / "plugins/validator", ROOT / "plugins/report_reader")
"""Where narratives are read."""
OF_FILES = {"netconvert.py", "evidence_gate.py", "sumo_xsd.py", "nhtsa_xml.py", "evidence.py"}
"""Those that match fields of answers, lines of programs, bytes of files and names of cases, not what a report says."""

HOMOGRAPHS = {"ram": ["make", "model_pickup"], "parked": ["object", "state"]}
"""Words of two meanings."""


def _one(**fields: object) -> RuleRecord:
    return rule_record("made.yaml", "it", {"pattern": "struck", **fields})


def test_every_rule_and_word_class_reads_its_examples() -> None:
    assert faults(language()) == []


def test_sentences_are_read_by_the_rules_told_for_them() -> None:
    assert reading_faults(language()) == []


@pytest.mark.parametrize(("id", "sentence", "facts"), facts_of_sentences())
def test_the_whole_reader_draws_the_fact_of_a_rule_from_a_sentence(
    id: str, sentence: str, facts: dict[str, object]
) -> None:
    drawn = {fact.field: fact.value for fact in read(sentence).facts if fact.rule == id}
    assert {field: list(value) if isinstance(value, tuple) else value for field, value in drawn.items()} == facts


def test_every_light_weather_and_surface_has_a_sentence_that_gives_its_fact() -> None:
    covered = {id for id, _, _ in facts_of_sentences()}
    of_conditions = {id for role in ("light", "weather", "surface") for id in language().roles[role]}
    assert of_conditions - covered == set()


def test_every_role_that_is_asked_in_order_has_sentences() -> None:
    assert set(sentences()) == roles_asked_for()


def test_every_rule_of_such_a_role_reads_a_sentence() -> None:
    reading = {id for told in sentences().values() for ids in told.values() for id in ids}
    assert {id for role in sentences() for id in language().roles[role]} - reading == set()


def test_code_asks_for_every_rule_and_for_no_other() -> None:
    in_roles = {id for role in roles_asked_for() for id in language().roles[role]}
    assert asked_for() | in_roles == set(language().rules)


def test_code_and_rules_use_every_word_class() -> None:
    texts = [p for r in language().rules.values() for p in r.alternatives]
    texts += [p for c in language().classes.values() for p in (c.pattern or "", *c.words)]
    included = {name for c in language().classes.values() for name in c.includes}
    used = {name for text in texts for name in data.SLOT.findall(text)} | included | classes_asked_for()
    generators = {"model_suv", "model_pickup", "model_van", "model_truck", "model_motorcycle"}
    assert set(language().classes) - used - generators == set()


def test_only_homographs_stand_in_two_classes_of_words_with_meanings() -> None:
    seen: dict[str, list[str]] = {}
    for one in language().classes.values():
        for word in one.words if one.plain else ():
            seen.setdefault(word, []).append(one.name)
    twice = {word: names for word, names in seen.items() if len(names) > 1}
    assert twice == HOMOGRAPHS


FILES = [file for folder in READERS for file in sorted(folder.glob("*.py")) if file.name not in OF_FILES]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_readers_have_no_pattern_of_their_own(file: Path) -> None:
    calls = [
        node.lineno for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        and isinstance(node.func.value, ast.Name) and node.func.value.id == "re" and node.func.attr != "escape"
    ]  # fmt: skip
    assert calls == [], f"{file.name} lines {calls}: give the pattern a record in sgcad_core/reading/language/rules"


def test_a_rule_without_examples_is_a_fault() -> None:
    (said,) = rule_faults(language(), _one())
    assert "made.yaml" in said
    assert "'made.it': it has no example; add a sentence" in said


def test_an_example_that_is_read_otherwise_shows_how_it_is_read() -> None:
    (said,) = rule_faults(language(), _one(examples=["V1 «hit» V2, which struck it"]))
    assert "V1 hit V2, which «struck» it" in said


def test_a_counterexample_that_is_read_is_a_fault() -> None:
    (said,) = rule_faults(language(), _one(examples=["V1 «struck» V2"], counterexamples=["awestruck"]))
    assert "counterexample 'awestruck'" in said


def test_examples_tell_spans_and_groups_of_every_place() -> None:
    made = _one(pattern="(?P<side>{hand}) lane", examples=["«left lane», «right lane» -> side=left || side=right"])
    assert list(rule_faults(language(), made)) == []
    text, told = parsed(made.examples[0])
    assert text == "left lane, right lane"
    assert [place.says for place in told] == ["side=left", "side=right"]
    assert written(text, reads(language().pattern(made), text)) == made.examples[0]


def test_a_class_that_misses_a_word_is_a_fault() -> None:
    whole = language()
    fewer = replace(
        whole.classes["hand"], words={"left": "left"}, examples=("the «left» and the «right» -> left || right",)
    )
    (said,) = class_faults(Language({**whole.classes, "hand": fewer}, {}), fewer)
    assert "directions.yaml" in said


@pytest.mark.parametrize(("raw", "says"), [
    ({"pattern": "{nowhere}", "examples": ["x"]}, r"unknown slot \{nowhere\}; word classes are .*compass"),
    ({"pattern": "a(b", "examples": ["x"]}, "does not compile .*mend the pattern"),
])  # fmt: skip
def test_a_pattern_that_cannot_be_made_names_file_record_and_remedy(raw: dict[str, object], says: str) -> None:
    with pytest.raises(ConfigError, match=rf"made\.yaml, record 'made\.it': .*{says}"):
        language().pattern(rule_record("made.yaml", "it", raw))


@pytest.mark.parametrize(("raw", "says"), [
    ("struck", "it is str, not a mapping"),
    ({"pattern": "a", "paterns": "b"}, "unknown field paterns; known are about, any"),
    ({"pattern": "a", "any": ["b"]}, "both pattern and any"),
    ({"any": "a"}, "any is no list of texts"),
    ({"pattern": "a", "at": "end"}, "at is 'end'; write anywhere, start or whole"),
])  # fmt: skip
def test_a_record_that_cannot_be_read_names_file_record_and_remedy(raw: object, says: str) -> None:
    with pytest.raises(ConfigError, match=rf"made\.yaml, record 'it': .*{says}"):
        rule_record("made.yaml", "it", raw)


@pytest.mark.parametrize(("raw", "says"), [
    ({"words": "left"}, "words is str; give a list, or a mapping"),
    ({"about": "nothing"}, "neither words nor a pattern"),
])  # fmt: skip
def test_a_word_class_that_cannot_be_read_names_file_record_and_remedy(raw: object, says: str) -> None:
    with pytest.raises(ConfigError, match=rf"made\.yaml, record 'it': {says}"):
        word_class("made.yaml", "it", raw)


def test_a_rule_that_is_not_there_names_its_neighbors() -> None:
    with pytest.raises(ConfigError, match=r"lanes\.yaml, record 'lanes\.etch': there is no such rule; .*lanes\.each"):
        rule("lanes.etch").search("")


def test_a_role_that_is_not_there_names_those_that_are() -> None:
    with pytest.raises(ConfigError, match=r"no rule has this role; roles are .*deed"):
        of_role("dead")


def test_a_class_of_two_files_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "vocabulary").mkdir()
    for name in ("areas", "roads"):
        (tmp_path / "vocabulary" / f"{name}.yaml").write_text("part:\n  words: [door, wheel]\n")
    monkeypatch.setattr(data, "HERE", tmp_path)
    with pytest.raises(ConfigError, match=r"roads.yaml, record 'part': areas.yaml has a class of that name"):
        data.vocabulary.__wrapped__()


def test_no_record_stands_twice_in_its_file() -> None:
    for file in sorted(data.HERE.glob("*/*.yaml")):
        keys = [key.value for key, _ in yaml.compose(file.read_text(encoding="utf-8")).value]
        assert len(keys) == len(set(keys)), file.name


def test_classes_that_stand_in_themselves_are_refused() -> None:
    turning = word_class("made.yaml", "turning", {"pattern": "a{turning}"})
    with pytest.raises(ConfigError, match="slots nest deeper than 8"):
        Language({"turning": turning}, {}).pattern(_one(pattern="{turning}"))


def test_rules_of_a_role_come_in_the_order_of_their_weight() -> None:
    weights = [found.record.weight for found in of_role("deed")]
    assert weights == sorted(weights)


def test_words_come_with_those_of_included_classes() -> None:
    assert set(words("cardinal")) < set(words("compass"))
    assert values("compass")["southeast"] == "SE"
    assert data.vocabulary().slot("hand") == "(?:left|right)"


def test_given_words_are_no_patterns() -> None:
    whole_word = rule("makes.whole_word")
    assert whole_word.given(word="f.150").search("an f.150 pickup")
    assert not whole_word.given(word="f.150").search("an f-150 pickup")
