"""`sgcad score`: made runs against made labels, field by field, and how faults are told."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from flows.results.label_scoring import as_json, score
from sgcad_core.errors import BadInput
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.metrics.labels.course_labels import agreed, agreements, course_label
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

STEP_S, COUNT = 0.05, 121
CAR = {"type": "car", "length_m": 4.6, "width_m": 1.8}


@pytest.fixture(scope="module")
def net_xml():
    """Four legs with one lane each way around (0, 0); eastbound traffic drives south of the x axis."""
    spec = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in "NESW")))
    return compile_network(plain_xml(spec), spec).net_xml


def write(folder, case, net_xml, tracks, status="generated", objects=()):
    """A run's folder; tracks: actor -> (COUNT, 3) x, y, heading in degrees."""
    place = folder / case
    place.mkdir(parents=True)
    sizes = {a: {"length_m": 0.5, "width_m": 0.5, "type": "object"} if a in objects else CAR for a in tracks}
    actors = [{"id": actor, **sizes[actor]} for actor in tracks]
    (place / "result.json").write_text(json.dumps({"status": status, "actors": actors}))
    (place / "road.net.xml").write_text(net_xml)
    rows = ["t_s,actor,x_m,y_m,heading_rad,speed_mps"]
    for actor, track in tracks.items():
        rows += [
            f"{k * STEP_S:.3f},{actor},{x:.4f},{y:.4f},{math.radians(h):.5f},0" for k, (x, y, h) in enumerate(track)
        ]
    (place / "trajectories.csv").write_text("\n".join(rows))


def drive(speeds, start, heading=0.0, aside=0.0):
    """Eastward at the given speeds (m/s, one a step), drifting `aside` m to the left over the last second."""
    x = start[0] + np.concatenate(([0.0], np.cumsum(np.asarray(speeds[:-1]) * STEP_S)))
    y = start[1] + np.zeros(COUNT)
    return np.column_stack((x, y, np.full(COUNT, heading)))


def stand(x, y, heading):
    return np.tile([x, y, heading], (COUNT, 1)).astype(float)


BRAKING = [12.0] * 40 + list(np.linspace(12.0, 0.0, 40)) + [0.0] * 41
"""Over two seconds from 12 m/s to nothing: 15 m less than without."""


def labels(folder, **cases):
    folder.mkdir()
    for case, label in cases.items():
        (folder / f"{case}.json").write_text(json.dumps({"case": case, **label}))
    return folder


def rear_end(net_xml, folder):
    """V1 brakes east and touches V2, which stands; V2 then has a pole at its front."""
    v1 = drive(BRAKING, (-50.0, -1.6))
    v2 = stand(v1[-1, 0] + 4.5, -1.6, 0.0)
    write(folder, "a", net_xml, {"V1": v1, "V2": v2})


FULL = {
    "vehicles": {
        "V1": {"maneuver": "slowing", "lane": 1, "speed_mph": 26.8, "evasion": ["brake"],
               "rest": {"facing": "E", "where": "road"}},
        "V2": {"maneuver": "stopped", "rest": {"facing": "E", "where": "road"}},
    },
    "impacts": [["V1", "V2"]],
}  # fmt: skip


def test_what_is_told_and_driven_is_right(net_xml, tmp_path):
    rear_end(net_xml, tmp_path / "runs")
    table = score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=FULL)).table()
    fields = ("maneuver_any", "lane_told", "speed_told", "evasion", "rest", "rest_facing", "rest_where")
    assert {f: table[f][0] for f in fields} == dict.fromkeys(fields, 1.0)
    assert table["rest"] == (1.0, 2)


@pytest.mark.parametrize(
    ("vehicle", "change", "field"),
    [
        ("V1", {"maneuver": "straight", "evasion": ["steer_left"]}, "evasion"),
        ("V1", {"evasion": []}, "no_evasion"),
        ("V1", {"speed_mph": 40}, "speed_told"),
        ("V1", {"maneuver": "turn_left"}, "maneuver_any"),
        ("V1", {"maneuver": "lane_change_left"}, "maneuver_any"),
        ("V2", {"maneuver": "backing"}, "maneuver_any"),
        ("V2", {"rest": {"facing": "W"}}, "rest_facing"),
        ("V2", {"rest": {"where": "off_road"}}, "rest_where"),
        ("V2", {"rest": {"where": "shoulder", "side": "N"}}, "rest_side"),
        ("V2", {"rest": {"turned": "ccw"}}, "spin"),
    ],
)
def test_what_is_driven_otherwise_is_wrong(net_xml, tmp_path, vehicle, change, field):
    rear_end(net_xml, tmp_path / "runs")
    label = {"vehicles": {vehicle: change}, "impacts": []}
    assert score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=label)).table()[field] == (0.0, 1)


@pytest.mark.parametrize(
    ("impacts", "right"),
    [
        ([["V1", "V2"], ["V1", "pole"]], 1.0),
        ([["V1", "pole"], ["V1", "V2"]], 0.0),
        ([["V1", "V2"], ["V2", "tree"]], 0.0),
        ([["V1", "V2"], ["V1", "pole"], ["V1", "tree"]], 0.0),
    ],
)
def test_later_impacts_count_in_their_order(net_xml, tmp_path, impacts, right):
    v1 = drive([10.0] * COUNT, (-50.0, -1.6))
    tracks = {"V1": v1, "V2": stand(-20.0, -3.1, 0.0), "O1": stand(0.0, -2.0, 0.0)}
    write(tmp_path / "runs", "a", net_xml, tracks, objects=("O1",))
    label = {"vehicles": {}, "impacts": impacts}
    found = score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=label))
    assert found.table()["later_impacts"] == (right, 1)


def test_the_same_two_touch_again_only_after_they_were_apart(net_xml, tmp_path):
    v2 = stand(-20.0, -1.6, 0.0)
    v1 = drive([0.0] * COUNT, (-24.55, -1.6))
    v1[:20, 0] -= 3.0
    v1[40:60, 0] -= 3.0
    label = {"vehicles": {}, "impacts": [["V1", "V2"], ["V2", "V1"]]}
    write(tmp_path / "runs", "a", net_xml, {"V1": v1, "V2": v2})
    write(tmp_path / "runs", "b", net_xml, {"V1": drive([0.0] * COUNT, (-24.55, -1.6)), "V2": stand(-20.0, -1.6, 0.0)})
    b = json.loads((tmp_path / "runs/b/result.json").read_text())
    assert b["status"] == "generated"
    found = score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=label, b=label))
    assert found.marks["later_impacts"] == {"a": [1.0], "b": [0.0]}


def test_a_case_without_output_is_wrong_everywhere(net_xml, tmp_path):
    rear_end(net_xml, tmp_path / "runs")
    result = tmp_path / "runs/a/result.json"
    result.write_text(json.dumps(json.loads(result.read_text()) | {"status": "exhausted"}))
    table = score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=FULL)).table()
    assert {mean for mean, _ in table.values()} == {0.0}


def test_all_marks_are_written_for_other_programs(net_xml, tmp_path):
    rear_end(net_xml, tmp_path / "runs")
    found = score(tmp_path / "runs", labels=labels(tmp_path / "labels", a=FULL))
    written = json.loads(as_json(found))
    assert written["fields"]["rest"] == {"mean": 1.0, "count": 2}
    assert written["marks"]["evasion"] == {"a": [1.0]}
    assert "evasion" in found.text()


# ------------------------------------------------------------------ two readings
def test_only_what_both_readings_say_counts(net_xml, tmp_path):
    rear_end(net_xml, tmp_path / "runs")
    other = json.loads(json.dumps(FULL))
    other["vehicles"]["V2"]["rest"]["facing"] = "S"
    first, second = labels(tmp_path / "one", a=FULL), labels(tmp_path / "two", a=other)
    found = score(tmp_path / "runs", labels=first, second=second)
    assert found.table()["rest_facing"] == (1.0, 1)
    facing = next(a for a in found.agreement if a.field == "rest.facing")
    assert facing.agreed == 0.5


def test_kappa_is_one_for_the_same_and_none_for_chance():
    one = {"a": course_label({"vehicles": {"V1": {"maneuver": "straight"}, "V2": {"maneuver": "stopped"}}}, "a")}
    two = {"a": course_label({"vehicles": {"V1": {"maneuver": "stopped"}, "V2": {"maneuver": "straight"}}}, "a")}
    kappa = {a.field: a.kappa for a in agreements(one, one)}
    assert kappa["maneuver"] == 1.0
    assert next(a for a in agreements(one, two) if a.field == "maneuver").kappa == -1.0
    assert agreed(one["a"], two["a"]).vehicles["V1"].maneuver is None


# ------------------------------------------------------------------ faults
@pytest.mark.parametrize(
    ("label", "message"),
    [
        ({"vehicles": {"V1": {"manoeuvre": "straight"}}}, "unknown field manoeuvre; known are maneuver"),
        ({"vehicles": {"V1": {"maneuver": "flying"}}}, "maneuver is 'flying'; allowed are straight"),
        ({"vehicles": {"V1": {"evasion": ["jump"]}}}, "evasion is 'jump'; allowed are brake"),
        ({"vehicles": {"V1": {"rest": {"where": "moon"}}}}, "rest.where is 'moon'; allowed are road"),
        ({"impacts": [["V1"]]}, r"\['V1'\] is not a pair of names; write \[actor, other\]"),
    ],
)
def test_a_faulty_label_is_named_with_what_is_allowed(label, message):
    with pytest.raises(BadInput, match=message):
        course_label(label, "x")


def test_folders_without_runs_or_labels_are_told(net_xml, tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(BadInput, match=r"no <case>/result.json in it; give the folder of one config"):
        score(tmp_path / "empty")
    rear_end(net_xml, tmp_path / "runs")
    with pytest.raises(BadInput, match=r"no <case>.json in it; give the folder that holds the labels"):
        score(tmp_path / "runs", labels=tmp_path / "empty")
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad/a.json").write_text("{")
    with pytest.raises(BadInput, match=r"cannot be read"):
        score(tmp_path / "runs", labels=tmp_path / "bad")
