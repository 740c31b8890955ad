"""Edited text that knows where it was written."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.text.normalise import normalised
from sgcad_core.reading.text.privacy import redacted
from sgcad_core.reading.text.traced_text import TracedText, joined, placed, runs

EDITS = [
    (r"b", "xyz"), (r"(a)(b)", r"\2\1"), (r"a+", ""), (r"\s+", " "), (r"$", "!"), (r"^", ">"), (r"(a)|(b)", r"<\1>"),
    (r"(?<=a)(?=b)", "-"), (r"ab", "ab"), (r"abc", "aXc"),
]  # fmt: skip
LETTERS = st.text(alphabet="ab c", max_size=20)


@given(LETTERS, st.lists(st.sampled_from(EDITS), max_size=5))
@settings(deadline=None)
def test_edits_give_what_re_gives_and_places_stay_in_order_and_inside(text, edits):
    traced, plain = TracedText.of(text), text
    for pattern, to in edits:
        traced, plain = traced.sub(re.compile(pattern), to), re.sub(pattern, to, plain)
    assert traced.text == plain
    assert len(traced.starts) == len(traced.ends) == len(plain)
    assert list(traced.starts) == sorted(traced.starts)
    assert list(traced.ends) == sorted(traced.ends)
    assert all(0 <= a <= b <= len(text) for a, b in zip(traced.starts, traced.ends, strict=True))


def _lists(text: TracedText) -> tuple[str, list[int], list[int]]:
    return text.text, list(text.starts), list(text.ends)


@given(LETTERS)
@settings(deadline=None)
def test_splitting_and_joining_gives_what_strings_give(text):
    parts = TracedText.of(text).split(re.compile(" "))
    assert [p.text for p in parts] == text.split(" ")
    assert joined(parts, " ").text == text
    assert not all(p.text for p in parts) or _lists(joined(parts, " ")) == _lists(TracedText.of(text))
    assert joined(parts, "--").text == "--".join(text.split(" "))
    assert TracedText.of(text).strip().text == text.strip()
    assert TracedText.of(text).strip("a ").text == text.strip("a ")


def test_what_is_put_in_between_swapped_letters_keeps_the_order_of_places():
    swapped, swap = TracedText.of("aabb"), re.compile("(a)(b)")
    for _ in range(2):
        swapped = swapped.sub(swap, r"\2\1")
    put_in = swapped.sub(re.compile("(?<=a)(?=b)"), "-")
    assert list(put_in.starts) == sorted(put_in.starts)
    assert list(put_in.ends) == sorted(put_in.ends)


def test_only_what_changes_of_a_match_loses_its_place():
    edited = TracedText.of("at 30mph.").sub(re.compile(r"(\d+)(mph)"), r"\1 \2")
    assert edited.text == "at 30 mph."
    assert (edited.starts[6:], edited.ends[6:]) == ([5, 6, 7, 8], [6, 7, 8, 9])
    assert (edited.starts[5], edited.ends[5]) == (5, 5)


def test_at_most_so_many_matches_are_replaced():
    assert TracedText.of("aaa").sub(re.compile("a"), "b", 2).text == "bba"


@pytest.mark.parametrize(
    ("written", "piece", "original"),
    [
        ("Vehicle # 1 was at 50mph.It slowed.", "V1", "Vehicle # 1"),
        ("Vehicle # 1 was at 50mph.It slowed.", "mph", "mph"),
        ("Vehicle # 1 was at 50mph.It slowed.", "slowed", "slowed"),
        ("It hit it’s pole • of the north bound road", "northbound", "north bound"),
        ("on a 4 lane road", "four-lane", "4 lane"),
    ],
)
def test_what_normalising_rewrites_keeps_its_place(written, piece, original):
    text = normalised(TracedText.of(written))
    at = text.text.index(piece)
    start, end = text.cut(at, at + len(piece)).span
    assert written[start:end] == original


@given(st.text(alphabet="Vehicle #12.,()’\n he was struck 45-year-old male driver", max_size=120))
@settings(deadline=None, max_examples=200)
def test_runs_bring_places_back_and_none_beyond_its_edit(text):
    edited = normalised(redacted(TracedText.of(text)))
    back = placed(edited.text, runs(edited))
    assert back.text == edited.text
    pairs = zip(back.starts, back.ends, edited.starts, edited.ends, strict=True)
    assert all(c <= a and b <= d and (d - c != 1 or (a, b) == (c, d)) for a, b, c, d in pairs)


def test_an_untouched_text_has_no_runs_and_a_shortened_one_has():
    assert runs(TracedText.of("abc")) == ()
    assert runs(TracedText.of("abc").cut(1, 3)) == ((0, 1, 3),)
