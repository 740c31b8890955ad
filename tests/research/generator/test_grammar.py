"""The language of clauses: articles, numbered lanes, commas; and that what is said of others is what they do."""

import re
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator import words
from research.generator.clauses.error_clauses import CRITICAL
from research.generator.clauses.lane_lists import lane_phrase
from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Crash, Leg
from research.generator.grammar import fill, sentence, unmark
from research.generator.phrase_labels import labels_of
from research.generator.writer import Writer

COUNTS = {word: n for n, word in enumerate(words.NUMBERS)} | {"a": 1, "single": 1}


@pytest.mark.parametrize(
    ("made", "told"),
    [
        ("on a undivided road", "on an undivided road"),
        ("on a one-way road", "on a one-way road"),
        ("a eight-lane street, a 8-lane street", "an eight-lane street, an 8-lane street"),
        ("A 80-year-old made a U-turn", "An 80-year-old made a U-turn"),
        ("in the lane two of", "in lane two of"),
        ("in the lane 1", "in lane 1"),
        ("in the lane that V1 occupied", "in the lane that V1 occupied"),
    ],
)
def test_fillings_and_articles_agree(made: str, told: str) -> None:
    assert fill(made, lambda slot: slot) == told


def test_no_sentence_ends_in_a_comma() -> None:
    assert sentence("V1 struck V2, the Lexus,") == "V1 struck V2, the Lexus."


@settings(max_examples=200, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    lanes=st.integers(1, 6),
    turns=st.sampled_from([(), ("left",), ("right",), ("left", "right")]),
)
def test_lanes_told_add_up(seed: int, lanes: int, turns: tuple[str, ...]) -> None:
    if lanes < len(turns):
        return
    through = ["through"] * (lanes - len(turns))
    uses = ["right"] * ("right" in turns) + through + ["left"] * ("left" in turns)
    leg = Leg(0, lanes, 1, turns_in=uses if turns else [])
    told = unmark(lane_phrase(Random(seed), leg))[0]
    for turn in ("left", "right"):
        assert (turn in told) == (turn in turns)
    head, _, listed = told.partition(" lanes, ")
    if "one of them" in told or (listed and head in COUNTS):
        assert COUNTS.get(told.split(" ")[0], told.split(" ")[0]) in (lanes, str(lanes))
    if "one of them" not in told:
        counted = re.findall(
            r"(\w+) (?:single |through |left[ -]turn |right[ -]turn )?lanes?\b",
            listed if head in COUNTS or head.isdigit() else told,
        )
        assert sum(int(COUNTS.get(n, n)) for n in counted) == lanes


def _crashes(config: str, wanted: int) -> list[Crash]:
    found, seed = [], 0
    while len(found) < wanted:
        crash = sample_crash(Random(seed))
        seed += 1
        if crash.config == config:
            found.append(crash)
    return found


def test_who_overtakes_is_said_to_overtake() -> None:
    for crash in _crashes("overtaking", 40):
        culprit, _ = Writer(Random(1), crash, False, 0.3).who
        assert crash.actors[culprit].maneuver == "overtaking"


@pytest.mark.parametrize("held_out", [False, True])
def test_others_are_said_to_do_what_they_do(held_out: bool) -> None:
    said: set[str] = set()
    for seed, crash in enumerate(_crashes("rear_end", 40)):
        writer = Writer(Random(seed), crash, held_out, 0.3)
        _, other = writer.who
        for _ in range(10):
            clause = writer._true_of(other, CRITICAL["rear_end"])
            states = labels_of(clause) & {"stopped", "slowing"}
            assert states <= {crash.actors[other].maneuver}, clause
            said |= states
    assert said == (set() if held_out else {"stopped", "slowing"})


def test_a_name_with_a_comma_owns_its_parts() -> None:
    assert fill("{S}'s front", {"S": "V1, the Ford,"}.__getitem__) == "V1, the Ford's front"
