"""Records of phrases: in the language of phrases, apart from what is held out, and faults that name what to mend."""

import re
from collections.abc import Iterable, Mapping
from importlib.resources import files
from typing import Any

import pytest

from research.generator import phrase_labels, records
from research.generator.records import Group, Phrase, group, slots_of
from sgcad_core.errors import ConfigError

FILES = ("codes", "contact", "critical", "motion", "noise", "road", "scene", "turning", "vehicles", "words")
LISTS = [(name, heading) for name in FILES for heading in records.records(name)]
RUN = 4
"""Words in a row that no further phrase may share with held-out ones alone."""
ALIKE = {"dir": "from", "surf": "Surf", "road": "Road"}
"""Slots that tell the same in other words."""


def sections(name: str, heading: str) -> tuple[list[Phrase], list[Phrase]]:
    """The counted phrases of a list, and the further ones with those that only train."""
    found = records.records(name)[heading]
    return list(found["counted"]), [*found.get("further", ()), *found.get("training", ())]


def words_of(phrase: Phrase) -> str:
    return phrase_labels.plain(phrase_labels.marked(phrase.text))


def resolved(clause: str, limit: int = 400) -> list[str]:
    """What a phrase may become, up to a limit."""
    found = [clause]
    while any("[" in one for one in found) and len(found) < limit:
        next_round: list[str] = []
        for one in found:
            choice = re.search(r"\[([^\[\]]*)\]", one)
            options = choice[1].split("|") if choice else [""]
            next_round += [one.replace(choice[0], option, 1) for option in options] if choice else [one]
        found = next_round
    return found[:limit]


def runs(clauses: Iterable[str]) -> set[tuple[str, ...]]:
    found = set()
    for clause in clauses:
        for one in resolved(clause):
            words = re.sub(r"[,;.:\[\]|]", " ", one.lower()).split()
            found |= {tuple(words[i : i + RUN]) for i in range(len(words) - RUN + 1)}
    return found


def test_every_file_of_phrases_is_read() -> None:
    found = {file.name.removesuffix(".yaml") for file in files("research.generator").joinpath("phrases").iterdir()}
    assert found == {*FILES, "labels", "incidents"}, "tests/research/rows/test_gist_rows.py reads incidents"


@pytest.mark.parametrize(("name", "heading"), LISTS)
def test_further_phrases_say_what_their_list_says_and_nothing_held_out(name: str, heading: str) -> None:
    counted, more = sections(name, heading)
    slots = {slot for phrase in counted for slot in slots_of(phrase.text)}
    slots |= {other for slot, other in ALIKE.items() if slot in slots}
    slots |= {"pedestrian", "person_on_foot", "walking_person", "walker"} if heading.endswith("pedestrian") else set()
    held = {words_of(phrase) for phrase in counted if phrase.split == "held_out"}
    private = runs(held) - runs(words_of(phrase) for phrase in counted if phrase.split != "held_out")
    for phrase in more:
        clause = words_of(phrase)
        assert phrase.split == "both", clause
        assert "|" not in re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", clause)), clause
        assert set(slots_of(clause)) <= slots, clause
        assert not (set(resolved(clause)) & held), clause
        assert not (runs([clause]) & private), clause


@pytest.mark.parametrize(("name", "heading"), LISTS)
def test_the_counted_phrases_keep_their_share(name: str, heading: str) -> None:
    _, more = sections(name, heading)
    found, texts = _group(name, heading), {phrase.marked for phrase in more}
    trained = found.side(False)
    assert texts <= set(trained)
    assert sum(text in texts for text in trained) / len(trained) <= records.SHARE + 0.15


@pytest.mark.parametrize(("name", "heading"), LISTS)
def test_what_only_trains_is_never_told_when_held_out(name: str, heading: str) -> None:
    held = set(_group(name, heading).side(True))
    assert held
    assert not held & {phrase.marked for phrase in records.records(name)[heading].get("training", ())}


@pytest.mark.parametrize(("name", "heading"), LISTS)
def test_a_further_phrase_is_written_once(name: str, heading: str) -> None:
    _, more = sections(name, heading)
    assert len({words_of(phrase) for phrase in more}) == len(more)


def _group(name: str, heading: str) -> Group:
    key, _, inner = heading.partition(".")
    found: Any = records.read(name)[key]
    return found[inner] if inner else found  # type: ignore[no-any-return]


def test_every_label_says_what_it_means_and_some_phrase_has_it() -> None:
    used = {
        label
        for name, heading in LISTS
        for phrases in records.records(name)[heading].values()
        for phrase in phrases
        for label in (*phrase.whole, *phrase_labels.inline(phrase.text))
    }
    assert used == set(phrase_labels.registry())
    assert all(label.says and label.lists for label in phrase_labels.registry().values())


def test_a_label_of_an_alternative_stays_only_where_that_is_chosen() -> None:
    met, struck = resolved(Phrase("{S} [met<mutual>|struck] {T}", needs=("manned",)).marked)
    assert phrase_labels.labels_of(met) == {"mutual", "manned"}
    assert phrase_labels.labels_of(struck) == {"manned"}
    assert phrase_labels.plain(met) == "{S} met {T}"


def test_a_list_without_held_out_phrases_serves_both_sides() -> None:
    found = group("one", "two")
    assert found.side(True) == found.side(False) == ("one", "two")
    assert group("one", "~two").side(True) == ("two",)


def test_phrases_are_taken_by_label_and_by_slot() -> None:
    found = group("{V} slid", "{V} hit {W}<two>", "{W} braked")
    assert found.without(False, ["two"]) == ("{V} slid", "{W} braked")
    assert found.without(False, [], ["W"]) == ("{V} slid",)
    assert found.without(True) == found.side(True)


@pytest.mark.parametrize(
    ("entry", "fault"),
    [
        (7, "7 is no phrase; write a text"),
        ({"tells": ["mutual"]}, "is no phrase; write a text"),
        ({"text": "{S} met {T}", "tell": ["mutual"]}, "unknown field 'tell'; use form, needs, order, split, tells"),
        (
            {"text": "{S} met {T}", "tells": ["mutuel"]},
            "'{S} met {T}': unknown label 'mutuel'; add it to phrases/labels",
        ),
        ({"text": "{S} met {T}", "needs": ["mutual"]}, "'mutual' stands in `needs`; it belongs in `tells`"),
        ({"text": "{S} met {T}", "needs": ["again"]}, "'again' is not asked for in IMPACT"),
        ({"text": "They met", "order": "struck"}, "'struck' needs one of the slots T, ta"),
        ({"text": "{S} [met {T}"}, "its brackets do not match; close every"),
        ({"text": "{S} met {T}", "weight": 0}, "weight 0; use a whole number from 1"),
        ({"text": "{S} met {T}", "split": "test"}, "split 'test'; use both or held_out or trains"),
        ("{S} [met<mutuel>|hit] {T}", "unknown label 'mutuel'"),
    ],
)
def test_a_fault_names_file_phrase_and_remedy(entry: Any, fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    _write(monkeypatch, {"IMPACT": {"counted": [entry]}})
    with pytest.raises(ConfigError, match=re.escape(fault)) as raised:
        records.read("made")
    assert str(raised.value).startswith("phrases/made.yaml: IMPACT.counted: ")


def test_a_section_that_there_is_not_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    _write(monkeypatch, {"IMPACT": {"more": ["{S} hit {T}"]}})
    with pytest.raises(ConfigError, match=r"IMPACT\.more is no section; use counted, further, training"):
        records.read("made")


def _write(monkeypatch: pytest.MonkeyPatch, lists: Mapping[str, Any]) -> None:
    load = phrase_labels.load
    monkeypatch.setattr(phrase_labels, "load", lambda name: lists if name == "made" else load(name))
    records.records.cache_clear()


def test_a_label_of_a_field_that_there_is_not_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = {"odd": {"field": "sees", "says": "nothing", "lists": ["*"]}}
    monkeypatch.setattr(phrase_labels, "load", lambda name: entry)
    with pytest.raises(ConfigError, match="odd has the field 'sees'; use one of"):
        phrase_labels.registry.__wrapped__()
