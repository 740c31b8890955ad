"""One reading a case: facts with their sentences, in the text as it was written."""

import copy
import pickle
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from research.generator.report import make_report
from sgcad_core.case.records import Context, CrashReport
from sgcad_core.config import load
from sgcad_core.reading import reading as reader
from sgcad_core.reading.language.data import vocabulary
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import normalize
from sgcad_core.reading.text.privacy import redacted
from sgcad_core.reading.text.traced_text import TracedText, placed, runs
from sgcad_core.settings import ROOT
from tests.effort import spread

TEXT = (
    "The crash occurred on a 4 lane,two-way road in “daylight”.Vehicle # 1 was northbound at 35mph.  Vehicle #2 was "
    "west bound and turned left. V2’s driver was a 45-year-old male. The front of V1 struck the left side of V2."
)
LONE = (
    "Vehicle 4 was northbound on a two-lane, two-way road. It crossed the centerline and struck a tree.",
    "The vehicle (V5) was traveling north and struck a tree.",
    "Unit 17 was eastbound on a street. It was stopped. The driver of unit 17 got out.",
)
WORDS = {"N": "north", "NE": "northeast", "E": "east", "SE": "southeast", "S": "south", "SW": "southwest",
         "W": "west", "NW": "northwest"}  # fmt: skip


def facts_of(text):
    return {fact.field: fact for fact in read(text).facts}


def sentence(text, fact):
    return text[fact.start : fact.end]


# ------------------------------------------------------------------ places
def test_a_fact_points_to_its_sentence_as_it_was_written():
    facts = facts_of(TEXT)
    assert sentence(TEXT, facts["vehicles.V1.heading"]) == "Vehicle # 1 was northbound at 35mph."
    assert sentence(TEXT, facts["roads.main.lanes_total"]).startswith("The crash occurred on a 4 lane,two-way road")
    assert sentence(TEXT, facts["contacts.0.striker_area"]) == "The front of V1 struck the left side of V2."


def test_redaction_moves_no_place():
    bare = redacted(TracedText.of(TEXT))
    assert "45" not in bare.text
    found = {f.field: f for f in read(placed(bare.text, runs(bare))).facts}
    assert sentence(TEXT, found["contacts.0.struck"]) == "The front of V1 struck the left side of V2."
    assert sentence(TEXT, found["conditions.light"]).startswith("The crash occurred")


def _says(fact, said):
    """Whether a sentence holds what a fact of it was read from, by what the fact is about."""
    last = fact.field.rsplit(".", 1)[1]
    if last in ("lanes_total", "lanes_each_way", "center_turn_lane") or last.startswith(("lanes_", "turn_lanes_")):
        return bool(re.search(r"lane|-way|turn|bound", said))
    if last in ("heading", "exit_heading"):
        opposite = list(WORDS)[(list(WORDS).index(fact.value) + 4) % 8]  # "from the south"
        return WORDS[fact.value] in said or WORDS[opposite] in said
    if last in ("speed_mph", "speed_limit_mph"):
        return bool(re.search(r"\d+ (?:mph|kmph)", said))
    if last in ("year", "make"):
        return str(fact.value).lower()[:4] in said or last == "make"
    if last in ("striker", "struck"):
        return bool(re.search(r"str[ui]ck|strik|hit|impact|contact|colli|rear-end|sideswip|clip|push|bump|ram|t-boned|"
                              r"into|slap|met|together|broadsid|scrap|graz|kick|tapp|caught|rubb|"
                              r"brush|(?:ran|rolled|drove) over", said))  # fmt: skip
    return True


@pytest.mark.parametrize("start", spread(range(0, 120, 40), 3))
def test_the_place_of_every_stated_fact_lies_in_the_narrative_and_holds_what_was_read(start):
    for seed in range(start, start + 40):
        text = make_report(seed, False, 0.6, {"text": 1.0}).narrative
        for fact in read(text).facts:
            if fact.status != "stated":
                continue
            assert fact.start is not None, fact
            assert 0 <= fact.start < fact.end <= len(text)
            assert _says(fact, normalize(sentence(text, fact)).lower()), (seed, fact, sentence(text, fact))


# ------------------------------------------------------------------ how sure
def test_told_inferred_and_assumed_differ_and_a_contradiction_is_believed_less():
    facts = facts_of(TEXT)
    assert (facts["vehicles.V1.speed_mph"].status, facts["vehicles.V1.speed_mph"].basis) == ("stated", "text")
    assert facts["vehicles.V1.kind"].basis == "default"
    assert facts["vehicles.V1.kind"].start is None
    surface = facts_of("It was raining. V1 was northbound.")["conditions.surface"]
    assert (surface.status, surface.value) == ("inferred", "wet")
    torn = facts_of("V1 was traveling north. V1 was traveling south. V1 struck V2.")["vehicles.V1.heading"]
    sure = facts["vehicles.V1.heading"]
    assert torn.confidence < sure.confidence
    assert facts["vehicles.V1.kind"].confidence < surface.confidence < sure.confidence


def test_what_nobody_tells_of_directions_is_an_assumption_of_the_first_vehicle_alone():
    facts = facts_of("V1 was behind V2. V1 struck the rear of V2.")
    assert (facts["vehicles.V1.heading"].basis, facts["vehicles.V1.heading"].value) == ("default", "N")
    assert facts["vehicles.V2.heading"].status == "inferred"


# ------------------------------------------------------------------ once
def test_a_case_splits_and_resolves_its_narrative_once(monkeypatch, tmp_path):
    counted = []
    split, resolve = reader.split_sentences, reader.resolve_sentences
    monkeypatch.setattr(reader, "split_sentences", lambda text: counted.append("split") or split(text))
    monkeypatch.setattr(reader, "resolve_sentences", lambda *told: counted.append("resolve") or resolve(*told))
    source = ROOT / "docs" / "demo" / "left-turn-at-signal"
    ending = run_case(load(ROOT / "configs" / "template.yaml"), Case(source, "c1"), tmp_path, "d1")
    assert ending.result["status"] == "generated"
    assert counted == ["split", "resolve"]
    told = {f["field"]: f for f in ending.result["facts"]}
    for vehicle in ("V1", "V2"):
        starts = [told[f"vehicles.{vehicle}.{name}"] for name in ("start_road", "start_lane", "start_speed_mph")]
        assert all(f["value"] is not None for f in starts)
        assert f"vehicles.{vehicle}.exit_road" in told
    assert told["vehicles.V1.start_speed_mph"]["basis"] == "default"


def test_context_and_report_hold_the_very_same_reading_and_copies_of_another_text_none():
    report = CrashReport(case="c", narrative=TEXT)
    assert Context.of(report).reading is report.reading
    assert report.model_copy(update={"narrative": "V1 was stopped."}).reading.crash.vehicles[0].maneuver == "stopped"
    assert copy.copy(report) == report


def test_a_reading_is_neither_pickled_nor_compared():
    report = CrashReport(case="c", narrative=TEXT)
    before = len(pickle.dumps(report))
    assert report.reading.crash.vehicles
    assert len(pickle.dumps(report)) == before
    assert report == CrashReport(case="c", narrative=TEXT)


# ------------------------------------------------------------------ robust
@pytest.mark.parametrize("text", LONE)
def test_a_lone_vehicle_of_any_number_is_read(text):
    (vehicle,) = read(text).crash.vehicles
    assert vehicle.id in ("V4", "V5", "V17")
    assert vehicle.heading_stated


def test_engines_and_times_of_day_number_no_vehicle():
    assert [v.id for v in read("V1 had a V8 engine. It was eastbound.").crash.vehicles] == ["V1"]


_VOCABULARY = sorted({w for c in vocabulary().classes.values() if c.plain for w in c.words})
_GLUE = ["V1", "V2", "V4", "V12", "Vehicle #3", "it", "the driver", ".", ",", "(", ")", "the", "of", "was", "struck",
         "by", "and", "35 mph", "\n\n", "in", "on", "a", "its", "both vehicles", "lane", "stop sign", "'s"]  # fmt: skip


@given(st.lists(st.one_of(st.sampled_from(_VOCABULARY), st.sampled_from(_GLUE)), max_size=50).map(" ".join))
@settings(max_examples=300, deadline=None)
def test_no_text_of_the_readers_own_words_raises_and_every_place_lies_inside(text):
    found = read(text)
    assert all(f.start is None or 0 <= f.start < f.end <= len(text) for f in found.facts)
    names = {v.id for v in found.crash.vehicles} | {o.id for o in found.crash.others}
    assert all({c.striker, c.struck} <= names for c in found.crash.contacts)
