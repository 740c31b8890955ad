"""Notes behind phrases: each says what its words tell and where they end, and answers look there."""

import re
from collections import Counter
from dataclasses import replace
from random import Random

import pytest
import torch
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
from research.model import answer_grammar
from research.model.batch import Taggers
from research.model.tokens import ROAD, SCENARIO, Coder, train_tokenizer
from research.rows.collate import collate
from research.rows.report_rows import road_ids, training_row
from tests.research.reports import text_report

seeds = st.integers(0, 10**6)
NAMES = {index: name for name, index in NOTES.items()}
names = st.lists(st.sampled_from(sorted(NOTES)), max_size=4)
COUNTS = {"a": 1, "an": 1, "a single": 1, **{word: lanes for lanes, word in enumerate(NUMBERS)}}
TOLD = re.compile(
    r".*\b(?P<count>a single|an?|one|two|three|four|five|six|seven|\d) (?P<rest>(?:(?!\b(?:and|or)\b|[,;]).)*)$", re.S
)


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


WAY = re.compile(
    r"\b(from (?:the )?)?(north|south|east|west)(?:ern)?(?:(?<!st)[ -]?(east|west))?(?:[ -]?(?:bound|ward|erly))*"
)
"""Words for a way; of a word that a slip doubled ("west west") the last."""


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


TOUCHING = {"sa": "front", "ta": "left"}


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


def pointed(coder: Coder, report: Report) -> dict[tuple[object, ...], list[set[str]]]:
    """What is noted at the phrases that each value of the answers points at, by the path of the value."""
    row = training_row(coder, report, None)
    assert report.behavior is not None
    walks = {ROAD: (answer_grammar.road_walk(), report.road),
             SCENARIO: (answer_grammar.behavior_walk(road_ids(report.road)), report.behavior)}  # fmt: skip
    paths, at = {}, row.ids.index(coder.special[ROAD])
    for task, (walk, answer) in walks.items():
        assert row.ids[at] == coder.special[task]
        at += 1
        for text, pick in answer_grammar.write(walk, answer):
            paths[at] = pick.path if pick else ()
            at += len(coder.piece(text))
    said = {place: {NAMES[index] for index in some} for place, some in row.notes}
    found = {paths[place]: [said[source] for source in sources if source in said] for place, sources in row.pointers}
    return {path: some for path, some in found.items() if some}


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_values_point_at_the_phrases_that_tell_them_and_at_no_others(coder: Coder, seed: int) -> None:
    report = make_report(seed, length=0.1, modes={"text": 1.0})
    crash = report.crash
    for path, phrases in pointed(coder, report).items():
        if path[0] == "contacts":
            contact = crash.contacts[path[1]]
            part = str(path[2]).removesuffix("_area")
            area = f"{crash.actors[getattr(contact, part)].id}.area={getattr(contact, f'{part}_area')}"
            assert str(path[2]).endswith("_area")
            assert all(area in some for some in phrases)
            continue
        assert path[0] == "legs"
        leg, told = crash.legs[path[1]], [dict(n.split("=") for n in some) for some in phrases]
        assert path[2] in ("lanes_in", "lanes_out", "turns_in")
        away = path[2] == "lanes_out"
        source = str((leg.bearing + 4 * away) % 8)
        items = [some for some in told if some.get("leg") == source]
        roads = [some for some in told if some.get("axis") == str(leg.bearing % 4)] if path[2] != "turns_in" else []
        assert all(some in items or some in roads for some in told)
        lanes = getattr(leg, "lanes_out" if away else "lanes_in")
        assert all(int(some["each"]) == lanes or (lanes == 0 and some["ways"] == "one") for some in roads)
        if away:
            assert all(int(item["lanes"]) == lanes for item in items)
        elif items:  # a road may be described twice
            assert sum(int(item["lanes"]) for item in items) % lanes == 0


def test_lanes_and_sides_do_point_at_phrases(coder: Coder) -> None:
    found = Counter(str(path[2]) for report in with_lists(40) if report.behavior for path in pointed(coder, report))
    assert min(found[key] for key in ("lanes_in", "lanes_out", "turns_in", "striker_area", "struck_area")) > 10


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


@pytest.mark.parametrize("held_out", [False, True])
def test_lanes_of_two_roads_in_one_sentence_point_each_at_its_own(coder: Coder, held_out: bool) -> None:
    seen = 0
    for seed in range(400):
        report = text_report(seed, held_out, length=0.2)
        ends = {told["axis"]: end for end, told in roads_of(report) if "axis" in told}
        if len(ends) < 2 or not report.behavior:
            continue
        for path, phrases in pointed(coder, report).items():
            if path[0] == "legs" and path[2] in ("lanes_in", "lanes_out"):
                axis = f"axis={report.crash.legs[path[1]].bearing % 4}"
                assert all(axis in some for some in phrases if any(name.startswith("axis") for name in some))
                seen += any(axis in some for some in phrases)
    assert seen > 20


def test_how_a_road_lies_is_never_asked_at_its_phrase(coder: Coder) -> None:
    reports = (text_report(seed, length=0.2) for seed in range(60))
    rows = [training_row(coder, report, None) for report in reports if any("axis" in t for _, t in roads_of(report))]
    assert len(rows) > 10
    batch = collate(rows, coder)
    assert batch.noted.shape[1] == phrase_notes.ASKED
    asked = [[index for index in said if not NAMES[index].startswith("axis")] for row in rows for _, said in row.notes]
    assert batch.noted.sum(dim=1).tolist() == [len(some) for some in asked]


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_in_careless_copies_phrases_are_asked_within_their_words(coder: Coder, seed: int) -> None:
    report = make_report(seed, length=0.3, modes={"text": 1.0})
    row = training_row(coder, report, None, worn=(0.3, 0.3))
    _, ends = coder.worn(report.narrative, 0.3, 0.3, Random(f"{report.seed} worn"))
    for end, _ in report.notes:
        at = next(at for at, _ in row.notes if ends[at + 1] > end)
        assert end - 40 < ends[at] <= end


def test_a_list_that_tells_nothing_for_sure_is_pointed_at_by_nothing(coder: Coder) -> None:
    """Beside a drawing of one carriageway sentences no longer tell the road's lanes, and no answer is read there."""
    for report in with_lists(10):
        mute = [(end, {f for f in facts if not f.startswith(("lanes", "turns"))}) for end, facts in report.sentences]
        row = training_row(coder, replace(report, sentences=mute), None)
        items = {at for at, said in row.notes if any(NOTES[f"leg={leg}"] in said for leg in range(8))}
        assert items
        assert not any(items.intersection(sources) for _, sources in row.pointers)


def test_a_batch_carries_the_notes_of_its_rows_and_heads_learn_them(coder: Coder) -> None:
    rows = [training_row(coder, report, None) for report in with_lists(4)]
    batch = collate(rows, coder)
    assert batch.phrases.tolist() == [i * batch.ids.shape[1] + at for i, row in enumerate(rows) for at, _ in row.notes]
    assert all(batch.noted.sum(dim=1) > 0)
    torch.manual_seed(0)
    heads = Taggers(16, 5, phrase_notes.ASKED, 7)
    states = torch.randn(len(batch.phrases), 16)
    before = float(heads.phrases(states, batch.noted).detach())
    step = torch.optim.Adam(heads.parameters(), lr=0.05)
    for _ in range(60):
        step.zero_grad()
        heads.phrases(states, batch.noted).backward()
        step.step()
    assert float(heads.phrases(states, batch.noted).detach()) < 0.5 * before
    assert float(heads.phrases(states[:0], batch.noted[:0]).detach()) == 0


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
