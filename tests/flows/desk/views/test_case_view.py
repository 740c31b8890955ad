"""The report on a case's page: sentences with facts, and those that the account has something against."""

from flows.desk.views.case_view import pieces_of

TEXT = "V1 was northbound. A purple balloon hovered. V1 struck V2."
SPANS = {0: (0, 18), 19: (19, 44), 45: (45, 58)}


def test_a_sentence_carries_the_gravest_mark_in_words():
    facts = [{"field": "vehicles.V1.heading", "start": 0}]
    items = [
        {"kind": "unread", "start": 21}, {"kind": "lacks", "start": 45}, {"kind": "contradicts", "start": 45},
        {"kind": "has", "start": 0}, {"kind": "guessed", "start": None},
    ]  # fmt: skip
    pieces, numbers = pieces_of(TEXT, SPANS, facts, items)
    assert [(p.text.strip(), p.marked) for p in pieces if p.number >= 0] == [
        ("V1 was northbound.", ""), ("A purple balloon hovered.", "not read"), ("V1 struck V2.", "contradicted")
    ]  # fmt: skip
    assert set(numbers) == set(SPANS)
    assert "".join(p.text for p in pieces) == TEXT
