"""Whatever a model or a user writes, the player and the check answer with InvalidOutput or a result."""

from __future__ import annotations

import contextlib
import re

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from tests.sgcad_core.formats.xosc_samples import (
    CROSSING,
    actor,
    at,
    crossroads,
    event,
    follow,
    lane,
    lane_change,
    scenario,
    speed_action,
    timing,
    trajectory,
    when,
    world,
)

K = np.arange(8)
ROAD = lane_index(crossroads().xodr).by_edge("W").id
RICH = scenario(
    {"V1": lane(ROAD, -1, 5), "V2": world(-80, -1.8)},
    event("a", lane_change(-1, 2), at(0.5))
    + event("b", speed_action(3, "cubic", "rate", 4), when('<TraveledDistanceCondition value="9"/>'), "parallel")
    + event("c", follow([(1, -60, 0, 0), (2, -50, 0, None)], timing("relative")), at(2, "greaterThan", "rising", 0.2)),
    {"V1": "$v"},
    at("${$v / 5}", "greaterThan"),
    parameters='<ParameterDeclaration name="v" parameterType="double" value="20"/>',
)
WRITTEN = write_xosc([actor("V1")], [trajectory("V1", K * 0.5, 0)], CROSSING)
TEXTS = [RICH, WRITTEN]
VALUES = re.compile(r'="([^"]*)"')
ODD = [
    "", "nan", "-INF", "1e400", "-1", "0", "1e9", "1e308", "-1e-9", "$", "$v", "${}", "${9**9**9}", "${1/0}", "V9", "é",
]  # fmt: skip
CHANGES = st.lists(st.tuples(st.integers(0, 10_000), st.sampled_from(ODD)), min_size=1, max_size=3)
TAG = re.compile(r"<[A-Z]\w*[^<>]*/>")


def survives(text):
    motions = ()
    with contextlib.suppress(InvalidOutput):
        motions = play(text, crossroads().xodr)
    assert all(np.isfinite(v).all() for m in motions for v in (m.x_m, m.y_m, m.heading_rad, m.speed_mps))
    for finding in xosc_findings(text, crossroads().xodr):
        assert finding.what


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(TEXTS), CHANGES)
def test_odd_attribute_values_are_no_crash(text, changes):
    for at_, odd in changes:
        spots = list(VALUES.finditer(text))
        spot = spots[at_ % len(spots)]
        text = f'{text[: spot.start()]}="{odd}"{text[spot.end() :]}'
    survives(text)


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(TEXTS), st.integers(0, 10_000), st.integers(0, 10_000))
def test_missing_and_moved_elements_are_no_crash(text, first, second):
    tags = list(TAG.finditer(text))
    gone, place = tags[first % len(tags)], tags[second % len(tags)]
    moved = text[: place.end()] + gone.group() + text[place.end() :]
    survives(moved)
    survives(text[: gone.start()] + text[gone.end() :])


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(TEXTS), st.integers(0, 10_000), st.integers(1, 200), st.text(max_size=8))
def test_torn_files_are_no_crash(text, start, length, junk):
    start %= len(text)
    survives(text[:start] + junk + text[start + length :])


def test_a_trajectory_of_years_is_no_memory_bomb():
    line = follow([(0, 0, 0, 0), (1e9, 1, 0, 0)], timing())
    assert len(play(scenario({"V1": world(0, 0)}, event("e", line, at(0))))[0].t_s) == 81


def test_the_samples_themselves_play():
    for text in TEXTS:
        assert xosc_findings(text, crossroads().xodr) == []
