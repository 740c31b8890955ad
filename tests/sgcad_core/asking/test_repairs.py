"""What a further attempt hears: faults, questions with their sentences, and every earlier answer that failed."""

import json

from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.asking.repairs import exclude, put_to_model, repair_text, value_at
from sgcad_core.case.records import Attempt, Finding, Hold
from sgcad_core.findings import Told

ANSWER = {"actors": [{"id": "V1", "maneuver": "straight", "lane": None}], "contacts": [{"striker": "V1"}]}


def told(value, field="vehicles.V1.maneuver"):
    return Told(field=field, value=value, by="rules", confidence=0.9, start=0, end=9, sentence=f"It was {value}.")


def question(value, where="V1.maneuver", **fields):
    return Finding(source="n", severity="question", what="other", where=where, told=told(value), **fields)


def attempt(number, said, findings):
    return Attempt(stage="scenario", number=number, answer=said, findings=findings)


def answer(maneuver):
    return json.dumps({**ANSWER, "actors": [{"id": "V1", "maneuver": maneuver}]})


def test_a_repair_shows_the_answer_and_numbers_the_faults():
    text = repair_text("{}", [Finding(source="s", what="no hub"), Finding(source="s", what="no lane")])
    assert "{}" in text
    assert "1. [s] no hub" in text
    assert "2. [s] no lane" in text


def test_a_question_quotes_its_sentence_and_leaves_the_answer_its_value():
    asked = Finding(source="n", severity="question", what="another maneuver", where="V1.maneuver", value="straight",
                    told=told("turn_left"))  # fmt: skip
    said = repair_text("{}", [asked])
    assert "vehicles.V1.maneuver = turn_left: 'It was turn_left.'" in said
    assert "Keep your value 'straight'" in said
    assert "cannot be used" not in said
    assert "cannot be used" in repair_text("{}", [asked, Finding(source="n", what="no JSON")])


def test_a_fault_quotes_the_sentence_that_it_rests_on():
    fault = Finding(source="n", what="no contact", told=told("V2 into V1", "contacts.0.striker"))
    assert "[n] no contact; the report: 'It was V2 into V1.'" in repair_text("{}", [fault])


def test_all_earlier_answers_that_failed_are_listed_with_the_reason_of_each():
    met = Finding(source="agreement", what="nothing touches", where="V1.maneuver")
    former = [attempt(1, answer("straight"), (question("parked"),)), attempt(2, answer("parked"), (met,))]
    text = repair_text(answer("slowing"), [met], former)
    assert "- attempt 1, V1.maneuver = \"straight\": other; the report: 'It was parked.'" in text
    assert '- attempt 2, V1.maneuver = "parked": [agreement] nothing touches' in text


def test_an_answer_that_stands_by_its_value_has_not_failed():
    text = repair_text(
        answer("straight"), [Finding(source="s", what="x")], [attempt(1, answer("straight"), (question("parked"),))]
    )
    assert "attempt 1" not in text


def test_a_model_hears_faults_and_soft_findings_with_a_sentence_only():
    doubt = Finding(source="meeting", severity="doubt", what="odd")
    note = Finding(source="n", severity="note", what="limit")
    fault = Finding(source="agreement", what="nothing touches")
    assert put_to_model([doubt, question("parked"), note, fault]) == (question("parked"), fault)


def test_of_findings_that_exclude_each_other_the_graver_one_is_put():
    def hold(maneuver):
        return (Hold(items="actors", key="id", values=("V1",), either=({"maneuver": (maneuver,)},)),)

    fault = Finding(source="s", what="must drive", holds=hold("straight"))
    asked = question("parked", holds=hold("parked"))
    assert put_to_model([asked, fault]) == (fault,)
    assert put_to_model([question("straight", holds=hold("straight")), fault])[0].severity == "question"


CHOICE = st.dictionaries(
    st.sampled_from("ab"), st.lists(st.integers(0, 2), min_size=1, unique=True).map(tuple), min_size=1
)
HOLDS = st.builds(
    Hold, items=st.just("legs"), at=st.integers(0, 1), either=st.lists(CHOICE, min_size=1, max_size=2).map(tuple)
)


@given(
    HOLDS,
    HOLDS,
    st.lists(st.fixed_dictionaries({"a": st.integers(0, 2), "b": st.integers(0, 2)}), min_size=2, max_size=2),
)
def test_findings_that_one_answer_satisfies_never_exclude_each_other(one, other, items):
    def met(hold):
        return any(all(items[hold.at][name] in values for name, values in choice.items()) for choice in hold.either)

    if met(one) and met(other):
        assert not exclude(Finding(source="a", what="a", holds=(one,)), Finding(source="b", what="b", holds=(other,)))


@given(st.text(max_size=30), st.text(max_size=30))
def test_any_place_of_any_answer_can_be_looked_up(text, where):
    value_at(text, where)
    value_at(json.dumps(ANSWER), where)


def test_places_are_those_that_findings_name():
    text = json.dumps(ANSWER)
    assert value_at(text, "V1.maneuver") == "straight"
    assert value_at(text, "actor V1")["id"] == "V1"
    assert value_at(text, "contacts[0]") == {"striker": "V1"}
    assert value_at(text, "contacts[3]") is None
    assert value_at(text, "actors[0].id") == "V1"
