"""Facts by people on real cases: kept, laid over, undone, refused; the real template chain, two writers at once."""

import json
import os
import re
import shutil
import threading
from pathlib import Path

import pytest

from flows.batch import config_folder
from flows.case import person_facts, revise_case
from flows.case.revise_command import _told
from flows.case.run_case import run_case
from flows.case_files import find_cases
from flows.case_files.find_cases import Case
from flows.desk import export_edits
from sgcad_core.config import load
from sgcad_core.errors import BadInput, ConfigError, WrongEdit
from sgcad_core.revision import read_edits

TEXT = (
    "V1, a 2001 Chrysler Sebring, 4-door sedan was traveling east on a two-lane, two-way road and was approaching a "
    "T-intersection. V2, a 1999 Chevrolet Blazer, was traveling south on a two-lane, two-way road and was approaching "
    "the same intersection. It was daylight and the roads were dry. The driver of V1 attempted to turn left at the "
    "intersection and the front of V2 struck the left side of V1.\n"
)
FILES = ("road.net.xml", "road.xodr", "scenario.xosc", "trajectories.csv", "metrics.json", "specs.json")


@pytest.fixture(scope="module")
def config():
    return load(Path("template.yaml"))


@pytest.fixture(scope="module")
def made_once(tmp_path_factory, config):
    place = tmp_path_factory.mktemp("made")
    finished(place, config, "c1")
    return place


@pytest.fixture
def case(tmp_path, made_once):
    """A finished case's folder of this test alone; its report lies in tmp_path/cases/c1."""
    shutil.copytree(made_once, tmp_path, dirs_exist_ok=True)
    return tmp_path / "runs" / "template" / "c1"


def finished(place, config, name):
    source = place / "cases" / name
    source.mkdir(parents=True)
    (source / "report.txt").write_text(TEXT)
    config_folder.write(place / "runs" / config.name, config)
    made = Case(source, name)
    run_case(config, made, place / "runs", find_cases.digest_of(made, config))
    return place / "runs" / config.name / name


def test_a_case_names_its_report_without_telling_where_it_lies_on_this_machine(case, tmp_path):
    assert (case / ".source").read_text() == "../../../cases/c1"
    assert person_facts.report_path(case) == tmp_path / "cases" / "c1"
    (case / ".source").write_text(str(tmp_path / "cases" / "c1"))  # as older versions have it
    assert person_facts.report_path(case) == tmp_path / "cases" / "c1"


@pytest.mark.parametrize("kind", ["pipe", "folder", "long", "gone"])
def test_an_odd_note_of_the_report_is_told(case, kind):
    (case / ".source").unlink()
    if kind == "pipe":
        os.mkfifo(case / ".source")
    elif kind == "folder":
        (case / ".source").mkdir()
    elif kind == "long":
        (case / ".source").write_text("x" * 200_000)
    with pytest.raises(BadInput, match="does not say where its report is"):
        revise_case.opened(case)


@pytest.mark.parametrize(
    "text", ["a: 2026-99-99", "!!int ''", "!!timestamp x", "[" * 20_000, "!!bool x", "\x00", "? [a]"]
)
def test_odd_yaml_is_told_as_such(case, text):
    (case.parent / "config.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"no YAML|no config"):
        revise_case.opened(case)
    (case.parents[2] / "cases" / "c1" / "facts.yaml").write_text(text)
    with pytest.raises(BadInput, match=r"no YAML|expected a mapping"):
        read_edits(case.parents[2] / "cases" / "c1" / "facts.yaml")


def left(folder):
    """All that a case says, but for the seconds it took."""
    result = json.loads((folder / "result.json").read_text())
    return {"result": result | {"seconds": None}} | {name: (folder / name).read_bytes() for name in FILES}


def source_of(folder):
    return folder.parent.parent.parent / "cases" / folder.name


def test_an_edit_stands_in_every_file_and_is_a_persons(case):
    revised = revise_case.revise(case, {"roads.N.lanes_forward": "3", "V2.speed_mph": 40}, who="ann", why="drawn so")
    assert revised.result["status"] == "generated"
    specs = person_facts.read_specs(case)
    assert next(r.lanes_forward for r in specs.road.roads if r.id == "N") == 3
    fact = next(f for f in revised.result["facts"] if f["field"] == "roads.N.lanes_forward")
    assert (fact["value"], fact["basis"]) == (3, "person")
    assert revised.result["person"]["facts"] == 2
    assert revised.result["person"]["read"]["roads.N.lanes_forward"] == 1
    assert [(e.who, e.why) for e in read_edits(source_of(case) / "facts.yaml")] == [("ann", "drawn so")] * 2


def test_an_edit_removes_what_a_killed_one_left_in_the_temporary_folder(case, tmp_path, monkeypatch):
    (left := tmp_path / "temporary" / "sgcad-temp-net-abcdefgh").mkdir(parents=True)
    (left / "lock").touch()
    monkeypatch.setattr("tempfile.tempdir", str(left.parent))
    revise_case.revise(case, {"roads.N.lanes_forward": "1"})
    assert not left.exists()


@pytest.mark.slow
def test_any_edits_undone_give_the_first_result_byte_for_byte(case):
    first = left(case)
    revise_case.revise(case, {"roads.N.lanes_forward": 2})
    revise_case.revise(case, {"junction.kind": "four_leg", "conditions.weather": "rain"})
    revise_case.revise(case, {"roads.N.lanes_forward": 1})
    for _ in range(3):
        revise_case.undo(case)
    assert left(case) == first
    assert not (source_of(case) / "facts.yaml").exists()
    with pytest.raises(WrongEdit, match="nothing to undo"):
        revise_case.undo(case)


def test_an_edit_applied_twice_changes_nothing_more(case):
    revise_case.revise(case, {"vehicles.V1.kind": "truck"})
    once = left(case)
    again = revise_case.revise(case, {"actors.V1.type": "truck"})
    assert not again.changed
    assert left(case) == once


def test_as_read_takes_one_fact_back_and_keeps_the_others(case):
    revise_case.revise(case, {"roads.N.lanes_forward": 2, "V2.speed_mph": 40})
    revised = revise_case.revise(case, {"roads.N.lanes_forward": "as_read"})
    assert [e.field for e in revised.edits] == ["vehicles.V2.speed_mph"]
    assert {r.lanes_forward for r in person_facts.read_specs(case).road.roads} == {1}


@pytest.mark.parametrize(
    ("facts", "reason"),
    [
        ({"roads.N.lanes_forward": 9}, "integer from 0 to 8"),
        ({"roads.N.lane_forward": 2}, "no such field; did you mean"),
        ({"vehicles.V1.maneuver": "turn_rigth"}, "did you mean 'turn_right'"),
        ({"vehicles.V7.kind": "bus"}, "there is no V7; there are V1, V2"),
        ({"roads.Q.lanes_forward": 2}, "there is no road Q"),
        ({"vehicles.V1.start_lane": 12}, "integer from 1 to 8"),
        ({"contacts.0.striker": "V1", "contacts.0.struck": "V1"}, "cannot strike itself"),
        ({"vehicles.V2.present": False}, "before it was generated as declared"),
        ({}, "no fact is given"),
    ],
)
def test_a_wrong_edit_is_refused_with_its_reason_and_changes_nothing(case, facts, reason):
    before = left(case)
    with pytest.raises(WrongEdit, match=reason):
        revise_case.revise(case, facts)
    assert left(case) == before
    assert not (source_of(case) / "facts.yaml").exists()


def test_facts_beside_a_report_hold_on_a_later_run_and_its_stamp_tells(tmp_path, config, case):
    made = Case(source_of(case), "c1")
    stamp = find_cases.digest_of(made, config)
    revise_case.note(made.source, {"contacts.0.struck_area": "front"}, who="ann")
    assert find_cases.digest_of(made, config) != stamp
    ending = run_case(config, made, tmp_path / "other", find_cases.digest_of(made, config))
    assert ending.result["collision"]["declared"]["struck_area"] == "front"
    assert ending.result["person"] == {"facts": 1, "disagreed": 1, "read": {"contacts.0.struck_area": "left"}}


def test_the_verdict_is_told_after_a_revision(case):
    revised = revise_case.revise(case, {"vehicles.V1.speed_mph": 25})
    first, verdict, *_, last = _told(revised)
    assert first == "c1: generated, as declared"
    assert verdict == revised.result["account"]["sentence"]
    assert re.fullmatch(r"in \d+\.\d s", last)


def test_a_revised_case_is_done_for_the_batch(config, case):
    revise_case.revise(case, {"V2.speed_mph": 40})
    made = Case(source_of(case), "c1")
    assert (case / ".digest").read_text() == find_cases.digest_of(made, config)


def test_facts_of_another_report_are_refused_by_name(case):
    revise_case.revise(case, {"V2.speed_mph": 40})
    (source_of(case) / "report.txt").write_text(TEXT.replace("east", "west"))
    with pytest.raises(BadInput, match=r"facts.yaml: was written for another report .*remove it"):
        revise_case.revise(case, {"V2.speed_mph": 50})


def test_a_report_that_is_gone_is_told_and_one_that_was_moved_is_named(tmp_path, case):
    moved = source_of(case).rename(tmp_path / "elsewhere")
    with pytest.raises(BadInput, match="is gone: put it back, or name it with --report"):
        revise_case.revise(case, {"V2.speed_mph": 50})
    assert revise_case.revise(case, {"V2.speed_mph": 50}, report=moved).changed


def test_an_actor_that_a_new_reading_no_longer_has_is_a_finding_and_the_case_goes_on(tmp_path, config, case):
    source = source_of(case)
    (source / "facts.yaml").write_text("edits:\n- {field: vehicles.V5.kind, value: bus}\n")
    result = run_case(config, Case(source, "c1"), tmp_path / "other", "d").result
    assert result["status"] == "generated"
    assert any("there is no V5" in note["text"] for note in result["notes"])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("edits: 3", "a list `edits`"),
        ("edits: []\nx: 1", "unknown key 'x'"),
        ("edits:\n- {field: roads.N.lanes, value: 2}", r"edits\[0\]: .*no such field"),
        ("edits:\n- {field: near_crash, value: 7}", r"edits\[0\]: near_crash: 7 is not possible"),
        ("edits:\n- {field: near_crash, value: true, when: soon}", r"edits\[0\].when"),
        ("edits: [", "no YAML"),
    ],
)
def test_a_broken_facts_file_is_told_by_file_value_and_remedy(tmp_path, text, reason):
    file = tmp_path / "facts.yaml"
    file.write_text(text)
    with pytest.raises(BadInput, match=reason):
        read_edits(file)


def test_who_saw_other_facts_is_refused(case):
    seen = revise_case.stamp_of(())
    revised = revise_case.revise(case, {"V2.speed_mph": 40}, who="ann", seen=seen)
    with pytest.raises(WrongEdit, match=r"changed meanwhile \(ann changed vehicles.V2.speed_mph\)"):
        revise_case.revise(case, {"V2.speed_mph": 50}, who="bob", seen=seen)
    assert revise_case.revise(case, {"V2.speed_mph": 50}, who="bob", seen=revised.stamp).changed


def test_two_writers_at_once_lose_nothing(case):
    facts = ({"V2.speed_mph": 40}, {"roads.N.lanes_forward": 2})
    threads = [threading.Thread(target=revise_case.revise, args=(case, given)) for given in facts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    kept = {e.field for e in read_edits(source_of(case) / "facts.yaml")}
    assert kept == {"vehicles.V2.speed_mph", "roads.N.lanes_forward"}
    result = json.loads((case / "result.json").read_text())
    assert result["person"]["facts"] == 2


def test_what_was_mended_is_exported_as_truth_that_the_mended_run_meets(tmp_path, case):
    from flows.results.label_scoring import score

    revise_case.revise(case, {"roads.N.lanes_forward": 2, "V2.speed_mph": 40})
    lines = export_edits.export(case.parent, tmp_path / "data")
    assert lines[0].startswith("1 mended cases with 2 facts by people, of which 2 were read otherwise")
    table = score(case.parent, tmp_path / "data" / "truth").table()
    right = {name: mean for name, (mean, _) in table.items() if "_error" not in name}
    assert right == {
        "generated": 1.0, "legs": 1.0, "vehicle_count": 1.0, "initial_heading": 1.0, "maneuver": 1.0,
        "collision_any": 1.0, "collision_pair": 1.0, "collision_areas": 1.0,
    }  # fmt: skip
    assert table["lane_count_error"][0] == 0
    row = json.loads((tmp_path / "data" / "rows.jsonl").read_text())
    assert next(leg["lanes_in"] for leg in row["layout"]["legs"] if leg["bearing"] == "N") == 2
    pair = json.loads((tmp_path / "data" / "pairs.jsonl").read_text())
    assert pair["read"]["values"]["roads.N.lanes_forward"] == 1


def test_nothing_mended_is_nothing_to_export(tmp_path, case):
    with pytest.raises(BadInput, match="no fact of these cases was changed"):
        export_edits.export(case.parent, tmp_path / "data")
