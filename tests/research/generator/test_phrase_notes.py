"""Notes behind phrases: each says what its words tell and where they end, and answers look there."""

import re
from collections import Counter
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator import phrase_notes
from research.generator.crash.world import WORDS, Actor
from research.generator.grammar import MARK, unmark
from research.generator.noise import slips
from research.generator.phrase_notes import MARKS, NOTES, Slots, noted, placed
from research.generator.records import slots_of
from research.generator.report import Report, make_report
from research.generator.words import NUMBERS
from research.model.tokens import Coder, train_tokenizer
from research.rows.report_rows import training_row
from tests.research.reports import text_report

seeds = st.integers(0, 10**6)
names = st.lists(st.sampled_from(sorted(NOTES)), max_size=4)
COUNTS = {"a": 1, "an": 1, "a single": 1, **{word: lanes for lanes, word in enumerate(NUMBERS)}}
TOLD = re.compile(
    r".*\b(?P<count>a single|an?|one|two|three|four|five|six|seven|\d) (?P<rest>(?:(?!\b(?:and|or)\b|[,;]).)*)$", re.S
)
WAY = re.compile(
    r"\b(from (?:the )?)?(north|south|east|west)(?:ern)?(?:(?<!st)[ -]?(east|west))?(?:[ -]?(?:bound|ward|erly))*"
)
"""Words for a way; of a word that a slip doubled ("west west") the last."""
TOUCHING = {"sa": "front", "ta": "left"}


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(200)))


def with_lists(count: int, held_out: bool = False) -> list[Report]:
    """The first reports without a drawing that list lanes."""
    found: list[Report] = []
    seed = 0
    while len(found) < count:
        report = text_report(seed, held_out, length=0.2)
        found += [report] * bool(items_of(report))
        seed += 1
    return found


def items_of(report: Report) -> list[tuple[int, int, str, int]]:
    """Items of lists of lanes: (end, leg, use, lanes)."""
    found = [(end, dict(n.split("=") for n in some)) for end, some in report.notes if some[0].startswith("leg=")]
    return [(end, int(told["leg"]), told["use"], int(told["lanes"])) for end, told in found]


@given(text=st.text("ab ,.;", max_size=8), some=names)
def test_a_noted_phrase_is_unmarked_to_its_words_and_names(text: str, some: list[str]) -> None:
    plain, sentences, found = unmark(noted(text, some) + f".{chr(MARK)}")
    assert plain == text + "."
    assert sentences == [(len(plain), 0)]
    words = text.rstrip(" ,.;")
    assert found == ([(len(words), some)] if words and some else [])


def test_a_name_that_nobody_asks_for_is_no_note() -> None:
    with pytest.raises(KeyError, match="heading=9"):
        noted("northbound", ["heading=9"])


@pytest.mark.parametrize("held_out", [False, True])
def test_items_say_what_their_words_say(held_out: bool) -> None:
    seen = slipped = 0
    for report in with_lists(60, held_out):
        for end, leg, use, lanes in items_of(report):
            words = TOLD.search(report.narrative[:end].lower())
            if words is None:  # a slip of the pen
                continue
            assert lanes == (COUNTS.get(words["count"]) or int(words["count"]))
            assert ("left" in words["rest"]) == (use == "left")
            assert ("right" in words["rest"]) == (use == "right")
            way, begun = WORDS[(leg + 4) % 8], max((e for e, _ in report.sentences if e < end), default=0)
            before = re.sub("[/-]", "", report.narrative[begun:end].lower())
            slipped += way not in before and f"{way[0]}b" not in before
            seen += 1
    assert seen > 150
    assert slipped < 0.02 * seen  # a slip of the pen


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_items_of_an_approach_sum_up_to_its_lanes(seed: int) -> None:
    report = make_report(seed, modes={"text": 1.0})
    for leg in report.crash.legs:
        own = [(use, lanes) for _, at, use, lanes in items_of(report) if at == leg.bearing]
        if own:
            assert sum(lanes for _, lanes in own) % leg.lanes_in == 0  # a road may be described twice
            assert {"left", "right"} & {use for use, _ in own} == {"left", "right"} & set(leg.turns_in)


def touching(report: Report, number: int) -> set[str]:
    """Names of the sides that touch at a contact."""
    contact, actors = report.crash.contacts[number], report.crash.actors
    sides = ((contact.striker, contact.striker_area), (contact.struck, contact.struck_area))
    return {f"{actors[index].id}.area={area}" for index, area in sides}


@settings(max_examples=150, deadline=None)
@given(seed=seeds, held_out=st.booleans())
def test_noted_sides_are_those_that_touch(seed: int, held_out: bool) -> None:
    report = make_report(seed, held_out, modes={"text": 1.0})
    noted_sides = {name for _, some in report.notes for name in some if ".area=" in name}
    assert noted_sides <= set().union(*(touching(report, number) for number in range(len(report.crash.contacts))))


@pytest.mark.parametrize("held_out", [False, True])
def test_most_told_contacts_are_noted_with_both_sides(held_out: bool) -> None:
    told = both = 0
    for seed in range(300):
        report = text_report(seed, held_out, length=0.0)
        rear_end = report.crash.contacts[0].struck_area == "back"  # often said in words that name no side
        if "areas.0" in report.stated and not rear_end:
            told += 1
            both += touching(report, 0) <= {name for _, some in report.notes for name in some}
    assert both > 0.7 * told > 70


def test_a_noted_way_is_the_one_in_its_words() -> None:
    """Or the opposite one where they say where somebody came from."""
    same = opposite = 0
    for seed in range(250):
        report = text_report(seed, length=0.0)
        for end, some in report.notes:
            way = next((int(name[8:]) for name in some if name.startswith("heading=")), None)
            found = list(WAY.finditer(report.narrative[max(0, end - 34) : end].lower()))
            if way is None or not found or found[-1].end() < min(end, 34) - 6:
                continue  # abbreviated, misspelled, or before the words "lanes" of an item
            told = WORDS.index(f"{found[-1][2]}{found[-1][3] or ''}")
            assert told in (way, (way + 4) % 8)
            same, opposite = same + (told == way), opposite + (told != way)
    assert same > 200
    assert 10 < opposite < 0.25 * same


def asked(clause: str, areas: dict[str, str], given: tuple[str, ...] = ()) -> list[list[str]]:
    """What the slots of a clause about V1 and V2 tell, one after the other."""
    one, other = (
        Actor(id=name, kind="car", leg=leg, out=leg + 4, maneuver="straight") for name, leg in (("V1", 4), ("V2", 2))
    )
    slots = Slots(clause, one, other, areas, given)
    return [slots.next(slot) for slot in slots_of(clause)]


@pytest.mark.parametrize(
    ("clause", "told"),
    [
        ("{S} hit the {ta} of {T} with its {sa}", [["id=V1"], [], ["id=V2", "V2.area=left"], ["V1.area=front"]]),
        ("With its {sa} {S} hit {T} in the {ta}", [[], ["id=V1", "V1.area=front"], ["id=V2"], ["V2.area=left"]]),
        ("{S} and {T} met; the {sa} of {S} hit {T}'s {ta}",
         [["id=V1"], ["id=V2"], [], ["id=V1", "V1.area=front"], ["id=V2"], ["V2.area=left"]]),
        ("{V} was {xb} behind {W}", [["id=V1"], ["heading=0"], ["id=V2"]]),
        ("{V} met {opp} traffic", [["id=V1"], ["heading=4"]]),
        ("From the {from}, {V} went {dir}", [["heading=0"], ["id=V1"], ["heading=0"]]),
        ("{sa} to {ta}, {S} hit {T}", [[], [], ["id=V1", "V1.area=front"], ["id=V2", "V2.area=left"]]),
    ],
)  # fmt: skip
def test_a_side_is_told_where_it_and_its_owner_are_named(clause: str, told: list[list[str]]) -> None:
    assert asked(clause, TOUCHING) == told


def test_slots_filled_with_other_words_tell_nothing() -> None:
    assert asked("{xb} traffic passes {V}", {}, ("xb",)) == [[], ["id=V1"]]
    assert asked("the {sa} of {S}", {}, ("sa",)) == [[], ["id=V1"]]


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("Eastbound traffic had {two} and westbound traffic had {one}", "two one"),
        ("There were {two} for eastbound traffic and {one} for westbound traffic", ""),
        ("Eastbound and westbound traffic had {two} and {one}, respectively", "one"),
        ("The road had {two} eastbound and {one} westbound", ""),
        ("Westbound: {one}; eastbound: {two}", "one two"),
    ],
)
def test_items_that_may_be_of_either_way_lose_their_notes(text: str, kept: str) -> None:
    marked = text.format(
        two=phrase_notes.item("two lanes", 6, "through", 2), one=phrase_notes.item("one lane", 2, "through", 1)
    )
    plain, _, found = unmark(placed(marked, {6: "eastbound", 2: "westbound"}))
    assert plain == text.format(two="two lanes", one="one lane")
    assert [{"leg=6": "two", "leg=2": "one"}[some[0]] for _, some in found] == kept.split()


def test_slips_of_the_pen_fall_as_if_no_mark_were_there() -> None:
    words = ["two lanes", "one eastbound lane", "a left turn lane and"] * 40
    marked = " ".join(phrase_notes.item(some, 6, "left", 1) for some in words)
    assert set(marked) & set(MARKS)
    for seed in range(20):
        slipped = slips(Random(seed), marked, 0.2)
        assert unmark(slipped)[0] == slips(Random(seed), " ".join(words), 0.2)
        assert len(unmark(slipped)[2]) == len(words)


@settings(max_examples=40, deadline=None)
@given(seed=seeds)
def test_the_tagged_token_is_the_last_within_the_phrase(coder: Coder, seed: int) -> None:
    report = make_report(seed, length=0.3, modes={"text": 1.0})
    row, (_, ends) = training_row(coder, report, None), coder.worn(report.narrative, 0.0, 0.0, Random(0))
    found = dict(row.notes)
    assert len(found) == len(row.notes)
    for end, some in report.notes:
        at = next(at for at in found if ends[at] <= end < ends[at + 1])
        assert {NOTES[name] for name in some} <= set(found[at])
    assert {tag for said in found.values() for tag in said} == {
        NOTES[name] for _, some in report.notes for name in some
    }


def roads_of(report: Report) -> list[tuple[int, dict[str, str]]]:
    """Phrases for roads whose lanes a report tells: their ends and what is noted there."""
    found = [(end, dict(n.split("=") for n in some)) for end, some in report.notes]
    return [(end, told) for end, told in found if "road" in told]


@pytest.mark.parametrize("held_out", [False, True])
def test_roads_are_noted_in_the_order_of_the_text_with_the_lanes_they_have(held_out: bool) -> None:
    seen = Counter[str]()
    for seed in range(400):
        report = text_report(seed, held_out, length=0.2)
        roads = roads_of(report)
        assert [told["road"] for _, told in roads][:1] == ["first"] * bool(roads)
        for _, told in roads:
            seen[told["road"] + " counted" * ("each" in told)] += 1
            if "each" not in told:
                continue
            leg = next(leg for leg in report.crash.legs if leg.bearing % 4 == int(told["axis"]))
            assert {leg.lanes_in, leg.lanes_out} - {0} == {int(told["each"])}
            assert leg.two_way != ("ways" in told)
        axes = {told["road"]: told["axis"] for _, told in roads if "axis" in told}
        assert len(set(axes.values())) == len(axes)
    assert min(seen[kind] for kind in ("first", "first counted", "second", "second counted")) > 5


def test_pronouns_behind_a_name_mean_its_driver() -> None:
    seen = 0
    for seed in range(60):
        report = text_report(seed)
        begun = 0
        ends = [0] + [end for end, _ in report.sentences]
        for end, names in report.notes:
            begun = max(at for at in ends if at < end)
            words = report.narrative[begun:end]
            if not re.search(r"\b(he|she|his|her)$", words, re.I):
                continue
            seen += 1
            (name,) = names
            assert name.startswith("id=V")
            paragraph = report.narrative.rfind("\n\n", 0, begun) + 1
            assert any(name in some for at, some in report.notes if paragraph < at < end)
    assert seen > 30
