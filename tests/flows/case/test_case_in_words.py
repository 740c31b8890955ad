"""What the command tells of one case."""

import pytest

from flows.case import case_in_words

SEEN = {"actor": "V1", "other": "V2", "actor_area": "right", "other_area": "front", "t_s": 4.2}
TOLD = {"striker": "V2", "struck": "V1", "striker_area": "front", "struck_area": "right"}
RESULT = {
    "status": "generated",
    "notes": [],
    "facts": [],
    "collision": {"declared": TOLD, "observed": SEEN, "realised": True},
}


def test_the_striker_of_the_report_is_told_first():
    assert case_in_words.lines([RESULT]) == ["at 4.2 s the front of V2 hits the right of V1, as the report tells"]


@pytest.mark.parametrize(
    ("collision", "line"),
    [
        (
            {"observed": {**SEEN, "actor_area": "left"}, "realised": False},
            "at 4.2 s the front of V2 hits the left of V1; the report tells that the front of V2 hits the right of V1",
        ),
        (
            {"observed": None, "realised": False},
            "no contact happens; the report tells that the front of V2 hits the right of V1",
        ),
        ({"declared": None, "realised": False}, "at 4.2 s the right of V1 hits the front of V2"),
    ],
    ids=["elsewhere", "none", "undeclared"],
)
def test_a_contact_that_is_not_the_declared_one_is_told_beside_it(collision, line):
    assert case_in_words.lines([RESULT | {"collision": RESULT["collision"] | collision}]) == [line]


@pytest.mark.parametrize(
    ("basis", "realised", "line"),
    [
        ("default", True, "no contact: V1 and V2 come to 0.6 m, the usual distance of a near crash"),
        ("told", True, "no contact: V1 and V2 come to 0.6 m, as the report tells"),
        ("told", False, "no contact: V1 and V2 come to 0.6 m, 1.5 m was wanted"),
    ],
)
def test_of_a_near_crash_it_is_told_how_near_they_come(basis, realised, line):
    near = {
        "declared": {"clearance_m": 0.6 if realised else 1.5, "clearance_basis": basis},
        "observed": {"actor": "V1", "other": "V2", "clearance_m": 0.62, "t_s": 5.0},
        "realised": realised,
    }
    nothing = {"declared": None, "observed": None, "realised": False}
    assert case_in_words.lines([RESULT | {"collision": nothing, "near_crash": near}]) == [line]


def item(kind, text, reason=""):
    return {"kind": kind, "text": text, "reason": reason}


def test_what_lacks_is_told_with_its_reason_and_what_was_assumed_in_one_line():
    items = [item("lacks", "V2 strikes V3", "the two do not touch"), item("has", "V1"), item("assumed", "V1 50 mph")]
    account = {"verdict": "lacking", "told": 2, "has": 1, "lacking": 1, "assumed": 1, "items": items}
    assert case_in_words.lines([RESULT | {"account": account}])[1:] == [
        "told 2, has 1, lacking 1, assumed 1",
        "lacking: V2 strikes V3 (the two do not touch)",
        "assumed: V1 50 mph",
    ]


def test_a_result_without_a_scenario_has_no_account_to_tell():
    assert case_in_words.account_lines(RESULT | {"account": {"verdict": "none", "items": []}}) == []
    assert case_in_words.account_lines(RESULT) == []


def test_several_cases_and_refused_ones_are_left_to_the_table():
    assert case_in_words.lines([RESULT, RESULT]) == []
    assert case_in_words.lines([RESULT | {"status": "refused"}]) == []


def test_traffic_is_told_in_a_line():
    told = {"density": "light", "per_km_and_lane": 5.0, "vehicles": [{}, {}], "moved": 1, "notes": ["limited"],
            "removed": {"found no room": 2}}  # fmt: skip
    assert case_in_words.lines([RESULT | {"traffic": told}])[-1] == (
        "traffic: 2 vehicles, light (5 per km and lane); left out: 2 found no room; 1 began elsewhere to keep clear; "
        "limited"
    )
    assert case_in_words.lines([RESULT | {"traffic": {"lacks": "no lane"}}])[-1] == "traffic: none (no lane)"
