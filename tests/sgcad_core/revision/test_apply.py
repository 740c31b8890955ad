"""A person's facts over specs: what is asked stands, what cannot be is told, undoing is exact."""

from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.case.records import Finding
from sgcad_core.reading.reading import read
from sgcad_core.reading.reading_with_edits import holds, with_edits
from sgcad_core.records.edits import AS_READ, Edit, by_person, canonical, effective
from sgcad_core.records.facts import Fact
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.revision import unapplied_edits
from sgcad_core.revision.actors import behavior_with_edits
from sgcad_core.revision.fields import EDITABLE, fields_of
from sgcad_core.revision.file import with_new_edits, without_last_edits
from sgcad_core.revision.finding_fields import overruled
from sgcad_core.revision.roads import roads_with_edits
from sgcad_core.revision.spec_to_layout import layout_of
from sgcad_core.revision.values import junction_kind_of, value_of
from sgcad_core.roads.layout import road_spec

TEXT = (
    "V1, a 2001 Chrysler Sebring, was traveling east on a two-lane, two-way road and approached a T-intersection. V2, "
    "a 1999 Chevrolet Blazer, was traveling south. V1 turned left and the front of V2 struck the left side of V1."
)
LAYOUT = RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("N", "S", "W")))
SPEC = road_spec(LAYOUT)
BEHAVIOR = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="W", direction="forward", maneuver="turn_left", exit_road="N"),
        Actor(id="V2", kind="suv", road="N", direction="forward", maneuver="straight", exit_road="S"),
    ),
    contacts=(Contact(striker="V2", struck="V1", striker_area="front", struck_area="left"),),
)


def edits(**values):
    return tuple(Edit(field=canonical(name.replace("__", ".")), value=value) for name, value in values.items())


def test_lanes_of_one_leg_change_and_no_others():
    laid = roads_with_edits(SPEC, LAYOUT, {"roads.N.lanes_forward": 3})
    assert [r.lanes_forward for r in laid.roads] == [3, 1, 1]
    assert roads_with_edits(laid, LAYOUT, {"roads.N.lanes_forward": 3}) == laid


def test_junctions_become_what_a_person_says_and_stand():
    for kind in ("none", "t", "four_leg", "driveway", "roundabout", "parking_lot", "ramp"):
        laid = roads_with_edits(SPEC, LAYOUT, {"junction.kind": kind})
        assert junction_kind_of(laid) == kind
        assert unapplied_edits(edits(junction__kind=kind), "road", laid) == []


def test_the_stem_lies_where_a_person_says():
    laid = roads_with_edits(SPEC, LAYOUT, {"junction.stem": "E"})
    assert value_of("junction.stem", laid, None) == "E"
    assert {r.id for r in laid.roads} == {"N", "S", "E"}


def test_a_leg_is_added_by_its_bearing_and_taken_away_by_its_name():
    more = roads_with_edits(SPEC, LAYOUT, {"roads.E.present": True})
    assert {r.id for r in more.roads} == {"N", "S", "W", "E"}
    assert {r.id for r in roads_with_edits(more, LAYOUT, {"roads.E.present": False}).roads} == {"N", "S", "W"}


def test_signs_stand_beside_the_main_road_where_nobody_says_where():
    plain = SPEC.model_copy(update={"roads": tuple(r.model_copy(update={"minor": False}) for r in SPEC.roads)})
    laid = roads_with_edits(plain, LAYOUT, {"junction.control": "stop"})
    assert [r.id for r in laid.roads if r.minor] == ["W"]


def test_another_heading_is_another_road_and_another_maneuver_another_exit():
    laid = behavior_with_edits(BEHAVIOR, SPEC, {"vehicles.V2.heading": "N", "vehicles.V1.maneuver": "turn_right"})
    assert [(a.road, a.exit_road) for a in laid.actors] == [("W", "S"), ("S", "N")]


def test_naming_the_struck_as_striker_turns_the_contact_around_and_sides_stay_with_their_vehicles():
    laid = behavior_with_edits(BEHAVIOR, SPEC, {"contacts.0.striker": "V1"})
    assert laid.contacts[0] == Contact(striker="V1", struck="V2", striker_area="left", struck_area="front")


def test_who_is_taken_out_takes_the_contacts_along():
    laid = behavior_with_edits(BEHAVIOR, SPEC, {"vehicles.V2.present": False})
    assert [a.id for a in laid.actors] == ["V1"]
    assert laid.contacts == ()


def test_somebody_joins_and_is_struck():
    facts = {"others.P1.present": True, "contacts.1.striker": "V1", "contacts.1.struck": "P1"}
    laid = behavior_with_edits(BEHAVIOR, SPEC, facts)
    assert [(a.id, a.kind) for a in laid.actors] == [("V1", "car"), ("V2", "suv"), ("P1", "pedestrian")]
    assert (laid.contacts[1].striker, laid.contacts[1].struck) == ("V1", "P1")


def test_an_avoided_contact_is_a_near_crash_and_back():
    near = behavior_with_edits(BEHAVIOR, SPEC, {"near_crash": True, "near_crash.clearance_m": 1.5})
    assert (near.contacts, near.near_crash.conflict, near.near_crash.clearance_m) == ((), BEHAVIOR.contacts[0], 1.5)
    assert behavior_with_edits(near, SPEC, {"near_crash": False}) == BEHAVIOR


def test_what_does_not_stand_is_told_with_its_reason():
    given = edits(vehicles__V9__kind="bus", V1__start_lane=4, contacts__5__striker="V1")
    told = unapplied_edits(given, "scenario", SPEC, BEHAVIOR)
    assert [f.where for f in told] == ["vehicles.V9.kind", "vehicles.V1.start_lane", "contacts.5.striker"]
    assert "there are V1, V2" in told[0].what
    assert "1 lane(s)" in told[1].what
    assert {f.severity for f in told} == {"doubt"}
    assert "there are N, S, W" in unapplied_edits(edits(roads__Q__lanes_forward=1), "road", SPEC)[0].what


def test_a_finding_from_the_narrative_yields_to_a_person_and_a_fault_of_the_drawing_does_not():
    lanes = Finding(source="road_narrative", what="has 2 lanes", where="roads N, S")
    given = edits(roads__N__lanes_forward=3)
    assert overruled(lanes, given).severity == "note"
    assert overruled(lanes, edits(roads__W__lanes_forward=3)).severity == "repair"
    assert overruled(lanes.model_copy(update={"source": "topology"}), given).severity == "repair"


def test_a_layout_comes_back_from_its_spec():
    bent = RoadLayout(legs=(Leg(bearing="N", lanes_in=2, lanes_out=1, curve="left", speed_limit_mph=45),
                            Leg(bearing="S", lanes_in=1, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=1,
                            control="stop")))  # fmt: skip
    assert layout_of(road_spec(bent)) == bent
    assert layout_of(road_spec(LAYOUT.model_copy(update={"circle_lanes": 1}))).circle_lanes == 1


# ------------------------------------------------------------------ the reading
def test_a_reading_goes_by_a_person():
    given = edits(V1__maneuver="straight", V2__heading="N", contacts__0__struck_area="front", junction__kind="four_leg")
    reading = with_edits(read(TEXT), given)
    assert [(v.maneuver, v.heading, v.heading_stated) for v in reading.crash.vehicles][1] == ("straight", "N", True)
    assert reading.crash.vehicles[0].maneuver == "straight"
    assert reading.crash.contacts[0].struck_may == ("front",)
    assert (reading.roads.junction.kind, reading.roads.junction.stated) == ("four_leg", True)
    person = {f.field for f in reading.facts if f.basis == "person"}
    assert person == {edit.field for edit in given}
    assert holds(reading.crash, given)
    assert not holds(read(TEXT).crash, given)


def test_a_person_says_how_a_vehicle_stopped_evaded_and_came_to_rest():
    said = edits(vehicles__V1__from_rest=True, V1__evasion="braking", V1__rest__where="shoulder",
                 V1__rest__side="left", V1__signal="red")  # fmt: skip
    made = with_edits(read(f"{TEXT} V1 steered right. V1 came to rest facing north."), said)
    course = made.crash.driven["V1"]
    assert (course.from_rest, course.brakes, course.steers) == (True, True, None)
    assert (course.rest.where, course.rest.side, course.rest.facing_deg) == ("shoulder", "left", 0.0)
    assert made.signals == {"V1": "red"}
    laid = behavior_with_edits(BEHAVIOR, SPEC, {e.field: e.value for e in said})
    assert value_of("vehicles.V1.rest.side", SPEC, laid) == "left"
    assert unapplied_edits(said, "scenario", SPEC, laid) == []
    facts = {f.field: f.value for f in made.facts if f.field.startswith("vehicles.V1.evasion")}
    assert facts == {"vehicles.V1.evasion": "braking"}


def test_a_reading_that_nobody_changed_is_the_same_one():
    reading = read(TEXT)
    assert with_edits(reading, ()) is reading
    assert with_edits(reading, edits(V1__maneuver=AS_READ)) is reading


def test_facts_of_a_person_take_the_place_of_the_text():
    told = Fact(field="vehicles.V1.heading", value="E", basis="text", status="stated", rule="x", confidence=0.9)
    other = told.model_copy(update={"field": "vehicles.V2.heading"})
    found = by_person([told, other], edits(V1__heading="W", V3__kind="bus"))
    assert [(f.field, f.value, f.basis) for f in found] == [
        ("vehicles.V1.heading", "W", "person"), ("vehicles.V2.heading", "E", "text"),
        ("vehicles.V3.kind", "bus", "person"),
    ]  # fmt: skip


# ------------------------------------------------------------------ any sequence
def _possible(field):
    kind = field.kind
    if kind.form == "flag":
        return st.booleans()
    if kind.form == "list":
        return st.just(())
    if kind.form in ("integer", "number"):
        return st.integers(int(kind.least) + 1, int(kind.most))
    return st.sampled_from(field.choices)


EDITS = st.lists(
    st.sampled_from(fields_of(SPEC, BEHAVIOR)).flatmap(lambda f: st.tuples(st.just(f.name), _possible(f))), max_size=6
)


@settings(max_examples=60, deadline=None)
@given(EDITS)
def test_laying_twice_changes_nothing_more(pairs):
    given_values = dict(pairs)
    road = roads_with_edits(SPEC, LAYOUT, given_values)
    assert roads_with_edits(road, LAYOUT, given_values) == road
    behavior = behavior_with_edits(BEHAVIOR, road, given_values)
    assert behavior_with_edits(behavior, road, given_values) == behavior


@settings(max_examples=60, deadline=None)
@given(EDITS)
def test_every_edit_stands_or_is_told(pairs):
    given_edits = [Edit(field=name, value=value) for name, value in pairs]
    values = {e.field: e.value for e in effective(given_edits)}
    road = roads_with_edits(SPEC, LAYOUT, values)
    behavior = behavior_with_edits(BEHAVIOR, road, values)
    told = {
        f.where
        for f in (
            *unapplied_edits(given_edits, "road", road),
            *unapplied_edits(given_edits, "scenario", road, behavior),
        )
    }
    for edit in effective(given_edits):
        if not edit.field.endswith(".heading"):
            assert edit.field in told or value_of(edit.field, road, behavior) == edit.value


@settings(max_examples=60, deadline=None)
@given(st.lists(EDITS.filter(bool), max_size=4))
def test_any_history_is_undone_step_by_step(revisions):
    history, states = (), [()]
    for pairs in revisions:
        first = Edit(field=pairs[0][0], value=pairs[0][1])
        new = [Edit(field=name, value=value, when=first.when) for name, value in dict(pairs).items()]
        longer = with_new_edits(history, new)
        assert with_new_edits(longer, new) == longer
        history, states = longer, [*states, longer] if longer != history else states
    for before in reversed(states[:-1]):
        history = without_last_edits(history)
        assert history == before
    assert without_last_edits(()) == ()


def test_every_field_of_a_case_is_one_of_the_editable_kinds_with_its_value():
    found = fields_of(SPEC, BEHAVIOR)
    assert {f.kind for f in found} <= set(EDITABLE)
    assert all(f.value == value_of(f.name, SPEC, BEHAVIOR) for f in found)
    assert next(f for f in found if f.name == "vehicles.V1.start_road").choices == ("N", "S", "W")
