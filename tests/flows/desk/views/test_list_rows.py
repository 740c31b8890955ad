"""Rows and choosing: what a result of any version comes to in the list, and which of them are asked for."""

import pytest

from flows.desk.views import filters
from flows.desk.views.filters import ListQuery
from flows.desk.views.list_rows import Row, disagreements, kind_of, row_of


def fact(field, value, basis="text", confidence=0.9, **more):
    return {
        "field": field,
        "value": value,
        "basis": basis,
        "status": "stated",
        "confidence": confidence,
        "start": None,
    } | more


def result(**changes):
    declared = {"striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "back"}
    return {
        "case": "c", "config": "kit", "status": "generated", "reason": "", "notes": [],
        "facts": [fact("junction.kind", "t")],
        "collision": {"declared": declared, "realised": True, "observed": None}, "near_crash": None,
        "account": {"verdict": "whole", "told": 3, "has": 3, "lacking": 0, "assumed": 1, "items": []},
    } | changes  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "trust"),
    [
        ({}, "whole"),
        ({"status": "refused"}, "refused"),
        ({"status": "exhausted"}, "broken"),
        ({"status": "failed"}, "broken"),
        ({"account": {"told": 3, "has": 2, "lacking": 1, "assumed": 0}}, "lacking"),
        ({"notes": [{"kind": "finding", "field": "", "subject": "", "text": "odd"}]}, "doubtful"),
        (
            {
                "notes": [
                    {
                        "kind": "finding",
                        "field": "",
                        "subject": "",
                        "text": "template: no posted speed limit is told of W; the map leaves it open",
                    }
                ]
            },
            "whole",
        ),
        ({"notes": [{"kind": "plan", "field": "", "subject": "", "text": "V1 stands by"}]}, "whole"),
        ({"account": None}, "doubtful"),
        ({"facts": [fact("roads.N.lanes_forward", 2), fact("roads.N.lanes_forward", 3, "diagram")]}, "doubtful"),
    ],
)
def test_trust_is_the_worst_that_is_known(changes, trust):
    assert row_of("kit/c", result(**changes)).trust == trust


def test_a_declared_crash_that_does_not_come_about_is_lacking():
    collision = result()["collision"] | {"realised": False}
    assert row_of("kit/c", result(collision=collision)).trust == "lacking"


def test_a_result_of_an_older_version_says_that_nobody_looked():
    row = row_of("kit/c", result(account=None, notes=["a line"]))
    assert (row.accounted, row.told, row.lacking) == (False, 1, 0)


def test_readers_disagree_where_their_values_differ_and_defaults_never_do():
    facts = [
        fact("a.b", 1),
        fact("a.b", 1, "diagram"),
        fact("c.d", "N"),
        fact("c.d", "S", "model"),
        fact("c.d", "W", "default"),
    ]
    assert disagreements(facts) == {"c.d": {"text": "N", "model": "S"}}


def contact(striker_area, struck_area, struck="V2", maneuver="straight"):
    pair = {"striker": "V1", "struck": struck, "striker_area": striker_area, "struck_area": struck_area}
    return {"collision": {"declared": pair}, "actors": [{"id": "V1", "maneuver": maneuver}]}


@pytest.mark.parametrize(
    ("told", "kind"),
    [
        (contact("front", "back"), "rear-end"), (contact("front", "front"), "head-on"),
        (contact("left", "right"), "sideswipe"),
        (contact("front", "left"), "angle"), (contact("front", "left", maneuver="turn_left"), "angle, turning"),
        (contact("front", "left", "P1"), "pedestrian"), (contact("front", "left", "B1"), "cyclist"),
        (contact("front", "left", "O1"), "object"), (contact("back", "left"), "backing"), ({}, ""),
    ],
)  # fmt: skip
def test_the_kind_of_crash_follows_from_the_declared_contact(told, kind):
    assert kind_of(told) == kind


def test_a_crash_with_an_e_scooter_is_called_so():
    told = contact("front", "left", "B1")
    told["actors"].append({"id": "B1", "type": "e_scooter", "maneuver": "straight"})
    assert kind_of(told) == "e-scooter"


# ------------------------------------------------------------------ choosing
ROWS = [
    Row("k/a", "k", "a", "generated", "whole", kind="angle", place="a T", confidence=0.9, told=5, accounted=True),
    Row(
        "k/b",
        "k",
        "b",
        "generated",
        "lacking",
        kind="rear-end",
        confidence=0.6,
        told=5,
        lacking=2,
        accounted=True,
        mended=1,
    ),
    Row("l/c", "l", "c", "refused", "refused", reason="no Contact told"),
    Row("l/d", "l", "d", "generated", "doubtful", kind="angle", confidence=0.5, doubts=3, disagreeing=1),
    Row("l/e", "l", "e", "failed", "broken"),
]


def names(**asked):
    return [row.case for row in filters.chosen(ROWS, ListQuery(**asked))]


def test_the_worst_cases_come_first():
    assert names() == ["e", "b", "d", "c", "a"]


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ({"trust": "lacking"}, "b"), ({"status": "generated"}, "bda"), ({"kind": "angle"}, "da"),
        ({"config": "l"}, "edc"),
        ({"flag": "lacking"}, "b"), ({"flag": "disagreeing"}, "d"), ({"flag": "mended"}, "b"), ({"below": 0.6}, "bd"),
        ({"text": "contact TOLD"}, "c"), ({"text": "nobody"}, ""), ({"place": "a T"}, "a"),
        ({"sort": "case", "reverse": True}, "edcba"), ({"sort": "confidence", "status": "generated"}, "dba"),
    ],
)  # fmt: skip
def test_filters_leave_what_is_asked_for(asked, found):
    assert "".join(names(**asked)) == found


def test_a_facet_counts_what_choosing_it_would_leave():
    counted = filters.counts(ROWS, ListQuery(kind="angle", config="l"))
    assert dict(counted["config"]) == {"k": 1, "l": 1}
    assert dict(counted["trust"]) == {"doubtful": 1}
    assert dict(counted["kind"])["angle"] == 1


def test_a_query_is_what_was_asked_and_back():
    asked = ListQuery(text="a b&c", trust="whole", flag="doubts", below=0.5, sort="case", reverse=True, page=3)
    pairs = dict(pair.split("=") for pair in asked.query(page=3).split("&"))
    assert pairs["text"] == "a+b%26c"
    assert ListQuery.of({k: v.replace("+", " ").replace("%26", "&") for k, v in pairs.items()}) == asked


@pytest.mark.parametrize(
    "query", [{"page": "-1"}, {"page": "9" * 40}, {"sort": "__class__"}, {"below": "nan"}, {"flag": "x"}]
)
def test_what_is_not_understood_is_not_asked(query):
    assert ListQuery.of(query) == ListQuery()


def test_pages_end_and_the_last_one_stands_for_those_behind_it():
    rows = ROWS * 50
    shown, number, pages = filters.page_of(rows, ListQuery(page=99))
    assert (len(shown), number, pages) == (50, 3, 3)


def test_next_and_before_follow_the_list():
    rows = filters.chosen(ROWS, ListQuery())
    before, after, number = filters.around(rows, "l/d")
    assert (before.case, after.case, number) == ("b", "c", 3)
    assert filters.around(rows, "gone")[2] == 0
