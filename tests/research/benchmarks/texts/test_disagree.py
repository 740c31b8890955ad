"""Coded narratives are held against the reading field by field, and blind ones show totals alone."""

import gzip
import json
from pathlib import Path
from typing import Any

import pytest

from research.benchmarks.texts import coded_cases, disagree

_TEXT = (
    "V1 was traveling north in lane one of a two-lane, undivided roadway. V2 was stopped ahead of V1 in the same lane. "
    "The front of V1 contacted the back of V2. V1 then departed the road on the right and its front struck a tree."
)


def _vehicle(id: str, maneuver: str) -> dict[str, Any]:
    return {"id": id, "manoeuvre_resolved": maneuver, "told": True}


def _event(actor: str, other: str, areas: tuple[str | None, str | None]) -> dict[str, Any]:
    return {"kind": "collision", "actor": actor, "other": other, "actor_area": areas[0], "other_area": areas[1]}


def _case(**changes: Any) -> dict[str, Any]:
    road = {
        "lanes_total": 2, "lanes_from_text": 2, "lanes_scope": "both_directions", "flow": "two_way_undivided",
        "twltl": False, "control": "none", "told": {"control": False},
    }  # fmt: skip
    network = {
        "intersections": 0, "told": {"intersection": True}, "relative_heading_v2_minus_v1": 0, "control": "none",
        "roads": [road],
    }  # fmt: skip
    events = [_event("V1", "V2", ("front", "back")), _event("V1", "tree", ("front", None))]
    vehicles = [_vehicle("V1", "straight"), _vehicle("V2", "stopped")]
    whole = {"id": "a-1", "text": _TEXT, "blind": False, "network": network, "vehicles": vehicles, "events": events}
    return whole | changes


def _marks(case: dict[str, Any]) -> dict[str, bool]:
    return {v.field: v.right for v in disagree.judged(case).verdicts}


def test_a_text_that_is_read_as_coded_agrees_in_every_field() -> None:
    marks = _marks(_case())
    assert set(marks) == set(coded_cases.FIELDS) - {"first_thing", "control"}
    assert all(marks.values())


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("maneuver", {"vehicles": [_vehicle("V1", "straight"), _vehicle("V2", "turn_left")]}),
        ("first_pair", {"events": [_event("V2", "V3", ("front", "back"))]}),
        ("first_sides", {"events": [_event("V1", "V2", ("front", "left"))]}),
        ("first_thing", {"events": [_event("V1", "animal", ("front", None))]}),
        ("later_events", {"events": [_event("V1", "V2", (None, None)), _event("V2", "tree", ("front", None))]}),
        ("vehicles", {"vehicles": [_vehicle("V1", "straight")]}),
    ],
)
def test_another_code_disagrees_in_its_field(field: str, changes: dict[str, Any]) -> None:
    assert not _marks(_case(**changes))[field]


def test_lanes_that_are_not_coded_are_not_judged() -> None:
    network = _case()["network"]
    network["roads"][0] |= {"lanes_total": None, "flow": "divided"}
    assert "lanes" not in _marks(_case(network=network))


def test_a_curb_on_the_way_to_the_first_contact_is_passed_over() -> None:
    events = [_event("V1", "curb", ("front", None)), *_case()["events"]]
    assert _marks(_case(events=events))["first_pair"]


@pytest.mark.parametrize("between", ["", "struck the curb with its right wheels. V1 then "])
def test_a_curb_before_the_first_thing_may_be_read_or_not(between: str) -> None:
    text = f"V1 was northbound on a two-lane road. V1 left it on the right and {between}struck a tree with its front."
    events = [_event("V1", "curb", ("right", None)), _event("V1", "tree", ("front", None))]
    marks = _marks(_case(text=text, events=events, vehicles=[_vehicle("V1", "straight")]))
    assert marks["first_thing"]
    assert marks["first_sides"]
    events[1] = _event("V1", "animal", ("front", None))
    assert not _marks(_case(text=text, events=events, vehicles=[_vehicle("V1", "straight")]))["first_thing"]


def test_blind_lines_show_totals_and_no_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = [_vehicle("V1", "straight"), _vehicle("V2", "turn_left")]
    lines = [_case(id=f"a-{n}", vehicles=wrong, blind=n < 6) for n in range(12)]
    file = tmp_path / "pool.jsonl.gz"
    file.write_bytes(gzip.compress("\n".join(map(json.dumps, lines)).encode()))
    disagree.main(["--pool", str(file), "--field", "maneuver", "--rows", str(tmp_path / "rows.jsonl")])
    shown = capsys.readouterr().out
    row = next(line for line in shown.splitlines() if line.startswith("maneuver"))
    assert row.split()[1:] == ["0.500", "12", "0.500", "12"]
    assert "6  coded turn_left | read stopped" in shown
    kept = {json.loads(line)["id"] for line in (tmp_path / "rows.jsonl").read_text().splitlines()}
    assert kept == {f"a-{n}" for n in range(6, 12)}


def test_a_run_of_words_that_goes_with_errors_is_found_with_its_rules_and_sentence() -> None:
    right = coded_cases.Verdict("maneuver", "straight", "straight", True)
    wrong = coded_cases.Verdict("maneuver", "stopped", "straight", False, ("a.rule",))
    good = [disagree.Row(f"g{n}", f"It was day. V1 drove north on road {n}.", False, [right]) for n in range(40)]
    bad = [disagree.Row(f"b{n}", f"It was day. V1 sat idle on road {n}.", False, [wrong]) for n in range(10)]
    shown = list(disagree.told([*good, *bad], "maneuver", 3))
    assert any("10 disagree, 0 agree" in line for line in shown)
    assert "    rules: a.rule 10" in shown
    assert any("V1 sat idle on road" in line for line in shown)
    assert len([line for line in shown if line.startswith("---")]) == 1
