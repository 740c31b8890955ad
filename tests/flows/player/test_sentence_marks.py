"""How each sentence of a report was read: the marks that player, desk and report page share."""

import json

import pytest

from flows.player.player_page import shown_in
from flows.player.sentence_marks import MARK_WORDS, MARKS, READ, sentence_at, told_sentences

TEXT = "V1 was northbound. A purple balloon hovered. V1 struck V2."
FACTS = [
    {"field": "vehicles.V1.heading", "start": 0, "end": 18}, {"field": "contacts.0.striker", "start": 45, "end": 58},
    {"field": "contacts.0.struck", "start": 45, "end": 58}, {"field": "vehicles.V1.kind", "start": None, "end": None},
]  # fmt: skip


def as_written(place):
    return place


def item(kind, start, end):
    return {"kind": kind, "start": start, "end": end}


def told(items=(), shown=as_written):
    return {TEXT[s.of : s.upto]: (s.fields, s.mark) for s in told_sentences(FACTS, items, shown)}


def test_a_sentence_with_facts_is_read_unless_the_account_has_something_against_it():
    assert {sentence: mark for sentence, (_, mark) in told([item("has", 0, 18)]).items()} == {
        "V1 was northbound.": READ, "V1 struck V2.": READ,
    }  # fmt: skip


def test_a_sentence_carries_the_gravest_thing_said_of_any_part_of_it():
    items = [item("lacks", 45, 58), item("contradicts", 48, 54), item("unread", 45, 50)]
    assert told(items)["V1 struck V2."] == (("contacts.0.striker", "contacts.0.struck"), "contradicts")


def test_a_sentence_of_which_nothing_was_read_stands_among_the_others():
    assert list(told([item("unread", 19, 44)])) == ["V1 was northbound.", "A purple balloon hovered.", "V1 struck V2."]


def test_a_sentence_that_was_left_out_of_the_text_as_shown_is_none():
    assert list(told(shown=lambda place: (0, 0) if place[0] else place)) == ["V1 was northbound."]


def test_a_place_within_a_sentence_belongs_to_it():
    sentences = told_sentences(FACTS, [], as_written)
    assert [sentence_at(sentences, at) for at in (0, 17, 30, 50, None)] == [0, 0, -1, 1, -1]


def test_every_mark_against_a_sentence_has_words():
    assert set(MARKS) == set(MARK_WORDS)


@pytest.mark.parametrize("page", ["", "no page", '<script type="application/json" id="data">{"sentences": 3}</script>'])
def test_a_page_that_tells_nothing_leaves_places_as_written(page):
    assert shown_in(page)((3, 9)) == (3, 9)


def test_a_players_page_knows_where_its_sentences_stand():
    data = json.dumps({"sentences": [{"of": 45, "start": 30, "end": 41}]})
    shown = shown_in(f'<script type="application/json" id="data">{data}</script>')
    assert (shown((45, 58)), shown((0, 18))) == ((30, 41), (0, 18))
