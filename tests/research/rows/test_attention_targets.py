"""Values point at the phrases that tell them."""

from collections import Counter
from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator import phrase_notes
from research.generator.crash.world import Actor
from research.generator.phrase_notes import NOTES, Slots
from research.generator.records import slots_of
from research.generator.report import Report, make_report
from research.model import answer_grammar
from research.model.tokens import ROAD, SCENARIO, Coder, train_tokenizer
from research.rows.collate import collate
from research.rows.report_rows import road_ids, training_row
from tests.research.reports import text_report

seeds = st.integers(0, 10**6)
NAMES = {index: name for name, index in NOTES.items()}


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


def asked(clause: str, areas: dict[str, str], given: tuple[str, ...] = ()) -> list[list[str]]:
    """What the slots of a clause about V1 and V2 tell, one after the other."""
    one, other = (
        Actor(id=name, kind="car", leg=leg, out=leg + 4, maneuver="straight") for name, leg in (("V1", 4), ("V2", 2))
    )
    slots = Slots(clause, one, other, areas, given)
    return [slots.next(slot) for slot in slots_of(clause)]


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
