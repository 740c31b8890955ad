"""The account's parts, each on one real execution: what is told otherwise lacks, what is told so is there."""

from dataclasses import replace

import numpy as np
import pytest

from sgcad_core.account.assumed import assumed_items
from sgcad_core.account.build import account_of
from sgcad_core.account.contacts import _evasion_items, actor_items, contact_items
from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.motion import judged, motion_items
from sgcad_core.account.notes import notes_of
from sgcad_core.account.places import place_items
from sgcad_core.account.unread_text import unread_items
from sgcad_core.account.words import named, phrase, shown
from sgcad_core.config import load
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import split_sentences
from sgcad_core.reading.text.traced_text import TracedText
from sgcad_core.records.course import CourseTold, Move, RestTold
from sgcad_core.records.facts import Fact
from sgcad_core.roads.lane_total_readings import may_be_of_one_half
from sgcad_core.settings import ROOT

DEMO = ROOT / "docs" / "demo" / "left-turn-at-signal"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The bundled left turn at a signal, executed."""
    from flows.case.chain import CaseRun
    from flows.case_files.find_cases import Case

    run = CaseRun(load("template.yaml", ("tracker=none",)), Case(DEMO, "c1"))
    run.go()
    record = run.record()
    return ExecutedCase(record.reading, record.network, record.scenario, record.execution, record.drawn)


def fact(field, value, **more):
    more = {"basis": "text", "status": "stated", "start": 3, "end": 9, "rule": "r", "confidence": 0.9, **more}
    return Fact(field=field, value=value, **more)


def telling(made, *facts):
    """The same execution, of a report that tells these facts beside or instead of its own."""
    kept = [f for f in made.reading.facts if f.field not in {g.field for g in facts}]
    return replace(made, reading=replace(made.reading, facts=(*kept, *facts)))


def of(items, field):
    return {item.field: item for item in items}.get(field)


# ------------------------------------------------------------------ kinds
@pytest.mark.parametrize(("said", "lacks"), [("hovercraft", True), ("golf cart", False), ("vehicle", False)])
def test_a_vehicle_of_no_known_kind_lacks_its_kind(made, said, lacks):
    text = f"V1, a {said}, was traveling north."
    sentences = split_sentences(TracedText.of(text))
    drawn = fact("vehicles.V1.kind", "car", basis="default" if said != "golf cart" else "text", start=None, end=None)
    reading = replace(telling(made, drawn).reading, sentences=sentences)
    found = of(unread_items(replace(made, reading=reading)), "text.kind")
    assert (found is not None and found.value == said) is lacks


# ------------------------------------------------------------------ where it turns into
@pytest.mark.parametrize(("maneuver", "drawn", "has"), [
    ("slowing", True, True), ("turn_left", True, False), ("slowing", False, False),
])  # fmt: skip
def test_one_that_is_met_before_it_turns_has_a_driveway_to_turn_into(made, maneuver, drawn, has):
    spec, behavior = made.network.spec, made.scenario.behavior
    first = behavior.actors[0].model_copy(update={"maneuver": maneuver})
    aside = next(road.id for road in spec.roads if road.id not in (first.road, first.exit_road))
    roads = tuple(r.model_copy(update={"kind": "driveway"}) if drawn and r.id == aside else r for r in spec.roads)
    case = replace(
        made, network=made.network.model_copy(update={"spec": spec.model_copy(update={"roads": roads})}),
        scenario=made.scenario.model_copy(
            update={"behavior": behavior.model_copy(update={"actors": (first, *behavior.actors[1:])})}
        ),
    )  # fmt: skip
    target = fact(f"vehicles.{first.id}.target", "driveway")
    assert judged(case, first.id, "target", target).has is has


# ------------------------------------------------------------------ the whole
def test_a_bundled_report_is_whole_and_its_counts_agree(made):
    told = account_of(made, made.reading.facts).summary()
    assert told["verdict"] == "whole"
    assert told["lacking"] == 0 < told["has"] == told["told"]
    assert told["told"] + told["assumed"] == len(told["items"])


def test_nothing_executed_is_no_verdict():
    assert account_of(None, ()).summary() == {
        "verdict": "none", "sentence": "there is no scenario", "told": 0, "has": 0, "lacking": 0, "assumed": 0,
        "unread": 0, "contradicts": 0, "items": [],
    }  # fmt: skip


def test_what_is_beyond_a_limit_lacks_and_makes_the_case_lacking(made):
    notes = notes_of("limit", ["V1: '200 mph' is told"], made.told)
    account = account_of(made, made.reading.facts, notes)
    assert account.verdict == "lacking"
    assert account.of("lacks")[0].reason == "beyond a limit of ours"
    assert account.of("lacks")[0].subject == "V1"


# ------------------------------------------------------------------ places
@pytest.mark.parametrize(("field", "so", "otherwise"), [
    ("junction.control", "signal", "stop"),
    ("junction.kind", "four_leg", "t"),
    ("roads.main.lanes_southbound", 2, 6),
    ("roads.main.speed_limit_mph", 35, 70),
    ("roads.cross.one_way", False, True),
    ("conditions.surface", "dry", "snow"),
    ("conditions.light", "day", "dark"),
])  # fmt: skip
def test_a_place_told_otherwise_lacks_with_what_is_there_instead(made, field, so, otherwise):
    assert of(place_items(telling(made, fact(field, so))), field).kind == "has"
    item = of(place_items(telling(made, fact(field, otherwise))), field)
    assert item.kind == "lacks"
    assert item.reason
    assert (item.start, item.end) == (3, 9)


# ------------------------------------------------------------------ actors and motion
def test_a_vehicle_that_is_told_and_not_there_lacks(made):
    gone = replace(made, scenario=made.scenario.model_copy(update={"actors": made.scenario.actors[:1]}))
    items = list(actor_items(gone))
    assert "lacks" in {item.kind for item in items if item.subject == "V2"}
    assert {item.kind for item in actor_items(made)} == {"has"}


@pytest.mark.parametrize(("field", "so", "otherwise"), [
    ("vehicles.V1.heading", "N", "E"),
    ("vehicles.V1.maneuver", "turn_left", "turn_right"),
    ("vehicles.V2.maneuver", "straight", "turn_left"),
])  # fmt: skip
def test_motion_told_otherwise_lacks(made, field, so, otherwise):
    assert of(motion_items(telling(made, fact(field, so))), field).kind == "has"
    assert of(motion_items(telling(made, fact(field, otherwise))), field).kind == "lacks"


def test_a_departure_is_compared_with_where_the_vehicle_left_the_road(tmp_path, made):
    from flows.case.chain import CaseRun
    from flows.case_files.find_cases import Case

    text = "V1 was traveling north. V1 departed the road to the right. The front of V1 struck a tree."
    (tmp_path / "report.txt").write_text(text)
    run = CaseRun(load("template.yaml", ("tracker=none",)), Case(tmp_path, "tree"))
    run.go()
    record = run.record()
    ran_off = ExecutedCase(record.reading, record.network, record.scenario, record.execution, record.drawn)
    for value, kind in (
        ("right", "has"),
        ("E", "has"),
        ("N", "has"),
        ("either", "has"),
        ("left", "lacks"),
        ("W", "lacks"),
    ):
        told = telling(ran_off, fact("vehicles.V1.departs", value))
        assert of(motion_items(told), "vehicles.V1.departs").kind == kind, value
    stays = of(motion_items(telling(made, fact("vehicles.V1.departs", "either"))), "vehicles.V1.departs")
    assert (stays.kind, stays.reason) == ("lacks", "it is on the road at its first contact")


@pytest.mark.parametrize(("text", "heads"), [
    ("V1 was backing south on a roadway. V2 was parked behind V1. The back of V1 struck the front of V2.", "N"),
    ("V1 was southbound. V1 stopped and backed up. V2 was parked. The back of V1 struck the front of V2.", "S"),
])  # fmt: skip
def test_a_told_way_of_one_that_backs_is_its_travel_unless_it_drove_so_before(tmp_path, text, heads):
    from flows.case.chain import CaseRun
    from flows.case_files.find_cases import Case

    (tmp_path / "report.txt").write_text(text)
    run = CaseRun(load("template.yaml", ("tracker=none",)), Case(tmp_path, "backs"))
    run.go()
    record = run.record()
    backs = ExecutedCase(record.reading, record.network, record.scenario, record.execution, record.drawn)
    told = of(motion_items(backs), "vehicles.V1.heading")
    assert told.kind == "has"
    faced = float(backs.tracks["V1"].heading_rad[0])
    assert np.sin(faced) == pytest.approx(1.0 if heads == "N" else -1.0, abs=0.05)


def test_motion_is_judged_as_executed_not_as_planned(made):
    """V2 mirrored in time drives backwards along its way."""
    tracks = [
        t if t.actor != "V2" else t.model_copy(update={"heading_rad": t.heading_rad + np.pi})
        for t in made.execution.trajectories
    ]
    turned = replace(made, execution=made.execution.model_copy(update={"trajectories": tuple(tracks)}))
    assert of(motion_items(made), "vehicles.V2.heading").kind == "has"
    assert of(motion_items(turned), "vehicles.V2.heading").kind == "lacks"


# ------------------------------------------------------------------ contacts
def test_a_contact_that_happens_is_there_and_one_that_cannot_lacks(made):
    assert {item.kind for item in contact_items(made)} == {"has"}
    far = [t if t.actor != "V2" else t.model_copy(update={"x_m": t.x_m + 50.0}) for t in made.execution.trajectories]
    missed = replace(made, execution=made.execution.model_copy(update={"trajectories": tuple(far), "contact": None}))
    assert "lacks" in {item.kind for item in contact_items(missed)}


# ------------------------------------------------------------------ assumed
@pytest.mark.parametrize(("given", "reason"), [
    ({"status": "default", "basis": "default"}, "not told"),
    ({"status": "inferred", "rule": "left_turn"}, "follows from what is told (left turn)"),
    ({"status": "inferred", "basis": "model"}, "answered by the model, and the evidence does not tell it"),
    ({"status": "stated"}, None),
    ({"status": "stated", "basis": "person"}, None),
])  # fmt: skip
def test_what_nobody_told_is_assumed_with_its_reason(made, given, reason):
    items = assumed_items(
        made, [fact("vehicles.V1.maneuver", "turn_left", **given), fact("junction.control", "signal")]
    )
    found = of(items, "vehicles.V1.maneuver")
    assert (found.reason if found else None) == reason


def test_a_junction_without_a_told_control_is_assumed_to_have_none_and_labels_are_no_assumptions(made):
    items = list(assumed_items(made, [fact("vehicles.V1.role", "initiator", status="default")]))
    assert [(item.field, item.value) for item in items] == [("junction.control", "none")]


def test_only_sentences_and_persons_tell():
    assert is_stated(fact("f", 1))
    assert is_stated(fact("f", 1, basis="person", status="inferred"))
    assert not is_stated(fact("f", 1, status="inferred"))
    assert not is_stated(fact("f", 1, basis="model"))


# ------------------------------------------------------------------ what was not read
def test_a_whole_report_leaves_nothing_unread(made):
    assert [item for item in unread_items(made) if item.kind == "lacks"] == []


@pytest.mark.parametrize(("text", "field", "value"), [
    ("V2 was slowing for a school bus.", "text.further", "school bus"),
    ("V1 swerved to avoid a stopped truck and struck V2.", "text.further", "stopped truck"),
    ("V1 was slowing for a queue of stopped vehicles when V2 struck it.", "text.further", "queue of stopped vehicles"),
    ("V1 was struck by the door of V2.", "text.struck", "door"),
    ("V1 stopped for pedestrians when V2 struck it.", "text.further", "pedestrian"),
    ("V1 was northbound when it went into the ditch.", "text.ground", "ditch"),
    ("V1 was northbound beside a retaining wall.", "text.ground", "retaining wall"),
    ("V1 was parked along the north curb.", "text.ground", None),
    ("V1 departed the road and came to rest in a driveway.", "text.ground", "driveway"),
    ("The rollover was preceded by an impact to a fire hydrant.", "text.struck", "hydrant"),
    ("V1 was northbound. V2 was southbound.", "text.ground", None),
])  # fmt: skip
def test_things_that_are_named_and_not_drawn_lack(made, text, field, value):
    sentences = split_sentences(TracedText.of(text))
    found = of(unread_items(replace(made, reading=replace(made.reading, sentences=sentences))), field)
    assert (found.value if found else None) == value


@pytest.mark.parametrize(("road", "half"), [
    ("V1 was northbound in lane 5 of a five-lane interstate.", True),
    ("V1 was northbound in lane 3 of a four-lane road.", True),
    ("V1 was northbound in lane 2 of a four-lane road.", False),
    ("V1 was northbound in lane 3 of a four-lane, undivided road.", False),
    ("V1 was northbound on a three-lane, divided road.", True),
])  # fmt: skip
def test_a_total_may_be_that_of_one_carriageway_where_the_words_allow_it(road, half):
    reading = read(f"{road} V2 was northbound. The front of V1 struck the back of V2.")
    assert may_be_of_one_half(reading.roads.roads[0], reading.crash) == half


# ------------------------------------------------------------------ words
@pytest.mark.parametrize(("field", "value", "words"), [
    ("vehicles.V2.start_speed_mph", 35, "V2 speed 35 mph"),
    ("vehicles.V1.rest.where", "ditch", "V1 rest ditch"),
    ("contacts.0.striker_area", "front", "contact 1 striking side front"),
    ("roads.main.lanes_total", 5, "road main lanes in all 5"),
    ("junction.control", "signal", "junction control signal"),
    ("junction.kind", "t", "junction kind T-intersection"),
    ("vehicles.V1.rest.lane_way", "S", "V1 rest in a lane toward S"),
    ("vehicles.V1.parked", True, "V1 parked"),
])  # fmt: skip
def test_items_are_named_as_people_speak(field, value, words):
    assert phrase(field, value) == words


def test_values_have_their_units():
    assert shown("vehicles.V1.start_speed_mph", 35) == "35 mph"
    assert shown("roads.main.turn_lanes", ("left", "right")) == "left, right"
    assert shown("x", None) == "none"
    assert named("impacts.1.areas") == ("later impact 2", "areas")


# ------------------------------------------------------------------ notes
def test_a_note_points_at_the_fact_that_it_is_about():
    facts = {f.field: f for f in (fact("vehicles.V1.start_speed_mph", 35), fact("vehicles.V2.heading", "N"))}
    note = notes_of("plan", ["V2: its heading was turned"], facts)[0]
    assert (note.field, note.subject, note.start) == ("vehicles.V2.heading", "V2", 3)
    assert notes_of("plan", ["the road is long"], facts)[0].field == ""


def test_a_note_on_two_vehicles_points_at_their_contact():
    facts = {f.field: f for f in (fact("contacts.0.striker", "V1"), fact("contacts.0.struck", "V2"))}
    assert notes_of("plan", ["the contact of V1 and V2 came late"], facts)[0].field == "contacts.0.striker"


def test_whom_the_text_describes_and_the_scenario_lacks_is_told_by_its_words(made):
    text = "The car (V1) was northbound. An old tractor (V7) stood by. A man on foot (V8) looked on."
    reading = replace(made.reading, sentences=tuple(split_sentences(TracedText.of(text))), called={"V8": "V1"})
    found = [item.text for item in unread_items(replace(made, reading=reading)) if item.field == "text.vehicle"]
    assert found == ["'old tractor' is named"]
    assert reading.text_of(reading.sentences[-1]) == "A man on foot (V1) looked on."


@pytest.mark.parametrize(("moves", "asked"), [(("departs", "crosses"), False), (("departs",), True)])
def test_a_vehicle_that_left_the_road_and_came_back_is_judged_by_its_moves(made, moves, asked):
    course = CourseTold(moves=tuple(Move(kind) for kind in moves), departs="right")
    crash = replace(made.reading.crash, courses={"V1": course})
    told = replace(made, reading=replace(made.reading, crash=crash))
    assert (judged(told, "V1", "departs", fact("vehicles.V1.departs", "right")) is not None) is asked


def test_evasions_of_a_near_crash_are_facts_with_their_sentence():
    text = (
        "Subject is behind a van. The van brakes. Subject brakes and steers left to avoid hitting the van in the rear."
    )
    told = {one.field: one for one in read(text).facts}["near_crash.V1.evasion"]
    assert (told.value, told.start) == ("braking_and_steering_left", text.index("Subject brakes"))


@pytest.mark.parametrize(("told", "speed", "left_m", "missed"), [
    ("braking", (15.0, 8.0), 0.0, None),
    ("braking", (15.0, 14.5), 0.0, "it hardly brakes"),
    ("steering_left", (15.0, 15.0), 1.0, None),
    ("steering_right", (15.0, 15.0), 1.0, "it hardly steers aside"),
    ("braking_and_steering", (15.0, 15.0), -1.0, "it hardly brakes"),
])  # fmt: skip
def test_a_told_evasion_that_is_hardly_driven_lacks(made, told, speed, left_m, missed):
    case = telling(made, fact("near_crash.V1.evasion", told))
    track = case.tracks["V1"]
    share = np.linspace(0.0, 1.0, len(track.t_s))
    x, y, heading = track.x_m[0], track.y_m[0], track.heading_rad[0]
    along, aside = 40.0 * share, left_m * share
    moved = track.model_copy(update={
        "x_m": x + along * np.cos(heading) - aside * np.sin(heading),
        "y_m": y + along * np.sin(heading) + aside * np.cos(heading),
        "heading_rad": np.full(len(share), heading), "speed_mps": speed[0] + (speed[1] - speed[0]) * share,
    })  # fmt: skip
    case.__dict__["tracks"] = {"V1": moved}
    (item,) = _evasion_items(case, float(track.t_s[-1]))
    assert (item.kind, item.reason) == (("has", "") if missed is None else ("lacks", missed))


# ------------------------------------------------------------------ rests at things
def test_a_rest_at_a_thing_that_nothing_touches_lacks(made):
    crash = made.reading.crash
    told = replace(crash, courses={"V1": CourseTold(rest=RestTold(against="light pole"))})
    other = replace(made, reading=replace(made.reading, crash=told))
    found = of(contact_items(other), "vehicles.V1.rest.against")
    assert found is not None
    assert (found.kind, found.reason) == ("lacks", "it touches none")
    driven = replace(crash, courses={"V1": CourseTold(rest=RestTold(against="curb"))})
    assert (
        of(contact_items(replace(made, reading=replace(made.reading, crash=driven))), "vehicles.V1.rest.against")
        is None
    )
