"""The report on a case's page: its sentences, numbered and marked."""

from flows.desk.views.case_view import pieces_of
from flows.player.player_page import told_in

TEXT = "V1 was northbound. A purple balloon hovered. V1 struck V2."
RESULT = {
    "facts": [
        {"field": "vehicles.V1.heading", "start": 0, "end": 18}, {"field": "contacts.0.striker", "start": 45, "end": 58}
    ],
    "account": {"items": [
        {"kind": "unread", "start": 21, "end": 40}, {"kind": "lacks", "start": 45, "end": 58},
        {"kind": "contradicts", "start": 45, "end": 58}, {"kind": "has", "start": 0, "end": 18},
        {"kind": "guessed", "start": None, "end": None},
    ]},
}  # fmt: skip


def test_a_sentence_carries_its_number_its_things_and_its_mark():
    pieces, told = pieces_of(TEXT, told_in("", RESULT))
    assert [(p.text, p.number, p.things, p.mark, p.marked) for p in pieces if p.number >= 0] == [
        ("V1 was northbound.", 0, ("V1",), "read", ""), ("purple balloon hove", 1, (), "unread", "not read"),
        ("V1 struck V2.", 2, ("contact",), "contradicts", "contradicted"),
    ]  # fmt: skip
    assert [one.of for one in told] == [0, 21, 45]
    assert "".join(p.text for p in pieces) == TEXT


def test_a_report_that_is_shorter_than_its_sentences_keeps_those_that_it_has():
    pieces, told = pieces_of(TEXT[:30], told_in("", RESULT))
    assert len(told) == 1
    assert "".join(p.text for p in pieces) == TEXT[:30]
