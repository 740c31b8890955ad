"""Findings as grammar: what is known cannot be said otherwise, what is not stays free."""

import json

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from plugins.backbone.engine.grammar import Grammar, GrammarCompiler
from sgcad_core.asking.prompts import answer_schema
from sgcad_core.asking.schema_holds import narrowed_schema
from sgcad_core.case.records import Hold
from sgcad_core.records.specs import BehaviorSpec, RoadLayout
from tests.plugins.backbone import tiny

MAKER = GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2])
OTHERS = ("V1", "V2", "V3", "P1", "O1")
TURNS_LEFT = Hold(items="actors", key="id", values=("V1",), others=OTHERS, either=({"maneuver": ("turn_left",)},))
FROM_SOUTH = Hold(
    items="actors", key="id", values=("V2",), others=OTHERS,
    either=({"road": ("S",), "direction": ("forward",)}, {"road": ("N",), "direction": ("backward",)}),
)  # fmt: skip
FIRST = Hold(items="contacts", at=0, either=({"striker": ("V2",), "struck": ("V1",), "struck_area": ("left",)},))
THREE = Hold(items="legs", at_least=3)
TWO_LANES = Hold(items="legs", key="bearing", values=("N", "S"), either=({"lanes_in": (1,), "lanes_out": (1,)},))


def accepts(grammar: Grammar, answer: object) -> bool:
    """Whether a grammar lets a model say an answer, whole."""
    track = grammar.track()
    text = json.dumps(answer, separators=(",", ":")) if not isinstance(answer, str) else answer
    ids = tiny.tokenizer().encode(text, add_special_tokens=False)
    return all(track.take(token) for token in ids) and track.complete


def grammar_of(spec: type, *holds: Hold) -> Grammar:
    return MAKER.grammar(narrowed_schema(answer_schema(spec), holds))


def actor(name: str, maneuver: str = "straight", road: str = "N", direction: str = "forward") -> dict[str, object]:
    return {
        "id": name, "kind": "car", "road": road, "direction": direction, "lane": None, "exit_road": None,
        "maneuver": maneuver, "speed_mph": None, "length_m": None, "width_m": None,
    }  # fmt: skip


def behavior(*actors: dict[str, object], contacts: tuple[tuple[str, str, str, str], ...] = ()) -> dict[str, object]:
    keys = ("striker", "struck", "striker_area", "struck_area")
    said = [dict(zip(keys, contact, strict=True)) for contact in contacts]
    return {"actors": list(actors), "contacts": said, "light": None, "weather": None, "surface": None}


@hypothesis_settings(max_examples=60, deadline=None)
@given(
    first=st.sampled_from(["straight", "turn_left", "stopped"]),
    second=st.sampled_from(["straight", "turn_left"]),
    road=st.sampled_from(["N", "S"]),
    direction=st.sampled_from(["forward", "backward"]),
    swapped=st.booleans(),
)
def test_the_named_vehicle_does_what_is_told_and_others_do_as_they_like(first, second, road, direction, swapped):
    actors = [actor("V1", first), actor("V2", second, road, direction), actor("P1", "stopped")]
    answer = behavior(*(actors[::-1] if swapped else actors))
    right = first == "turn_left" and (road, direction) in (("S", "forward"), ("N", "backward"))
    assert accepts(grammar_of(BehaviorSpec, TURNS_LEFT, FROM_SOUTH), answer) == right
    assert accepts(grammar_of(BehaviorSpec, FROM_SOUTH, TURNS_LEFT), answer) == right
    assert accepts(grammar_of(BehaviorSpec), answer)


@pytest.mark.parametrize(
    ("contacts", "right"),
    [
        ((("V2", "V1", "front", "left"),), True),
        ((("V2", "V1", "front", "left"), ("V1", "V2", "front", "back")), True),
        ((("V2", "V1", "front", "right"),), False),
        ((("V1", "V2", "front", "left"),), False),
        ((), False),
    ],
)
def test_only_the_first_contact_is_held(contacts, right):
    answer = behavior(actor("V1"), actor("V2"), contacts=contacts)
    assert accepts(grammar_of(BehaviorSpec, FIRST), answer) == right


@pytest.mark.parametrize(
    ("actors", "right"),
    [
        ((actor("V1", "turn_left"), actor("V2")), True),
        ((actor("V1", "turn_left"), actor("V2"), actor("O1")), True),
        ((actor("V1"), actor("V2")), False),
        ((actor("V1", "turn_left"), actor("O1")), False),
        ((actor("V1", "turn_left"),), False),
    ],
)
def test_places_are_held_one_by_one_and_with_what_else_is_known(actors, right):
    places = [Hold(items="actors", at=i, either=({"id": (name,)},)) for i, name in enumerate(("V1", "V2"))]
    for holds in ([*places, TURNS_LEFT], [TURNS_LEFT, *places], [places[1], TURNS_LEFT, places[0]]):
        assert accepts(grammar_of(BehaviorSpec, *holds), behavior(*actors)) == right


def leg(bearing: str, lanes_in: int, lanes_out: int) -> dict[str, object]:
    return {
        "bearing": bearing, "lanes_in": lanes_in, "lanes_out": lanes_out, "turns_in": [], "center_turn_lane": False,
        "median": "none", "kind": "road", "control": "none", "curve": "none", "speed_limit_mph": None,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("legs", "right"),
    [
        ((leg("N", 1, 1), leg("S", 1, 1), leg("E", 3, 2)), True),
        ((leg("N", 1, 1), leg("S", 1, 2), leg("E", 3, 2)), False),
        ((leg("N", 1, 1), leg("S", 1, 1)), False),
    ],
)
def test_legs_are_as_many_and_as_wide_as_told(legs, right):
    assert accepts(grammar_of(RoadLayout, THREE, TWO_LANES), {"legs": list(legs), "accesses": []}) == right


def test_a_refusal_stays_a_way_out():
    assert accepts(grammar_of(BehaviorSpec, TURNS_LEFT, FIRST), {"refuse": "too thin", "missing": []})


@pytest.mark.parametrize(
    "hold",
    [
        Hold(items="actors", key="id", values=("V1",), others=OTHERS, either=({"maneuver": ("fly",)},)),
        Hold(items="wheels", either=({"size": (1,)},)),
        Hold(items="contacts", at=0, either=({"striker": ("nobody",)},)),
    ],
)
def test_what_no_answer_could_meet_is_passed_over(hold):
    assert narrowed_schema(answer_schema(BehaviorSpec), [hold]) == narrowed_schema(answer_schema(BehaviorSpec), [])


def test_a_hold_reads_as_one_line():
    assert TURNS_LEFT.line() == "actors with id V1: maneuver turn_left"
    assert THREE.line() == "at least 3 legs"
    assert FIRST.line() == "contacts[0]: striker V2, struck V1, struck_area left"


@pytest.mark.parametrize(("first", "second"), [("V2", "O1"), ("O1", "V2")])
def test_of_two_holds_that_exclude_each_other_the_first_is_kept(first, second):
    holds = [Hold(items="actors", at=1, either=({"id": (name,)},)) for name in (first, second)]
    narrowed_ = grammar_of(BehaviorSpec, *holds)
    assert accepts(narrowed_, behavior(actor("V1"), actor(first)))
    assert not accepts(narrowed_, behavior(actor("V1"), actor(second)))


@pytest.mark.parametrize("order", [1, -1])
def test_a_place_beyond_the_most_items_is_passed_over(order: int) -> None:
    last = Hold(items="legs", at=3, either=({"bearing": ("W",)},))
    holds = [Hold(items="legs", at_most=3), last][::order]
    legs = narrowed_schema(answer_schema(RoadLayout), holds)["anyOf"][0]["properties"]["legs"]
    assert legs["minItems"] <= legs["maxItems"]
    assert Hold(items="legs", at_most=3).line() == "at most 3 legs"


@pytest.mark.parametrize(("bearings", "right"), [("NES", True), ("NESW", False)])
def test_no_more_legs_are_written_than_are_told(bearings: str, right: bool) -> None:
    answer = RoadLayout.model_validate({"legs": [{"bearing": b, "lanes_in": 1, "lanes_out": 1} for b in bearings]})
    grammar = grammar_of(RoadLayout, Hold(items="legs", at_most=3))
    assert accepts(grammar, json.loads(answer.model_dump_json())) == right
