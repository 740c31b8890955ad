"""A result against the truth: right is right, no output is wrong, and the figures are the public scorer's."""

import csv
import importlib.util
import json
from pathlib import Path as File

import numpy as np
import pytest

from sgcad_core.formats.sumo.net_xml import lanes_between
from sgcad_core.metrics.labels.label_match import GeneratedCase, compare, truth_figures
from sgcad_core.metrics.labels.motion_label_match import Path, first_touch, maneuver_shown, way_m
from sgcad_core.roads.lane_graph import road_counts

SHARED = File(__file__).resolve().parents[5] / "shared"
SCORER, LABELS = SHARED / "tools" / "score.py", SHARED / "data" / "dev" / "truth"
THEIRS = {
    "intersection_count_error": "ice", "lane_count_error": "lce", "connectivity_error": "ce",
    "maneuver": "manoeuvre", "collision_any": "collision_realised",
}  # fmt: skip
SIZE = (4.6, 1.8)
LABEL = {
    "network": {
        "segments": [
            {"from": n, "to": "J", "lanes_towards_to": 2, "lanes_towards_from": 1} for n in ("a", "b", "c")
        ],
        "intersections": 1,
        "components": 1,
    },
    "vehicles": [
        {"id": "V1", "initial_heading": "E", "manoeuvre": "straight"},
        {"id": "V2", "initial_heading": "N", "manoeuvre": "stopped"},
    ],
    "events": [
        {"kind": "collision", "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "left (door)"}
    ],
}  # fmt: skip


def straight(x, y, heading, speed, n=60):
    t = np.arange(n) * 0.05
    step = np.outer(t * speed, [np.cos(heading), np.sin(heading)])
    return Path(t, np.column_stack((np.array([x, y]) + step, np.full(n, heading))), SIZE)


def star(lanes):
    return road_counts({pair: n for node, n in lanes.items() for pair in ((node, "J"), ("J", node))})


CRASH = {"V1": straight(-20, 0, 0, 10), "V2": straight(0, 0, np.pi / 2, 0), "B1": straight(-20, 0, 0, 10)}
RIGHT = GeneratedCase(road_counts({(n, "J"): 2 for n in "abc"} | {("J", n): 1 for n in "abc"}), CRASH)


def test_the_truth_itself_has_no_error():
    found = compare(LABEL, RIGHT)
    assert {v for k, v in found.items() if k.split("_any")[0].endswith("error")} == {0.0}
    marks = ("vehicle_count", "initial_heading", "maneuver", "collision_any", "collision_pair", "collision_areas")
    assert all(found[k] == 1.0 for k in marks)


def test_no_output_is_wrong_in_every_field_that_is_stated():
    found = compare(LABEL, None)
    assert {k for k, v in found.items() if v == 1.0} == {k for k in found if "error" in k}
    assert {v for k, v in found.items() if "error" not in k} == {0.0}
    assert set(found) == set(compare(LABEL, RIGHT))


def test_a_half_wrong_network_has_half_an_error_and_counts_as_wrong():
    found = compare(LABEL, RIGHT._replace(roads=star({"a": 1, "b": 1, "c": 1})))
    assert found["lane_count_error"] == pytest.approx(1 / 3)
    assert found["lane_count_error_any"] == 1.0
    assert found["intersection_count_error_any"] == 0.0


def test_segments_are_counted_and_compared_one_by_one_where_their_number_is_right():
    turned = {("J", "a"): 2, ("a", "J"): 1, ("b", "J"): 2, ("J", "b"): 2, ("c", "J"): 2, ("J", "c"): 1}
    found = compare(LABEL, RIGHT._replace(roads=road_counts(turned)))
    assert (found["segment_count_error"], found["segment_lanes_error"]) == (0.0, pytest.approx(1 / 3))
    four = compare(LABEL, RIGHT._replace(roads=star({"a": 2, "b": 1, "c": 1, "d": 1})))
    assert four["segment_count_error"] == pytest.approx(1 / 3)
    assert "segment_lanes_error" not in four


def test_what_a_label_leaves_open_is_not_judged():
    bare = {"network": {"intersections": None, "components": None}}
    assert compare(bare, RIGHT) == {}
    assert truth_figures(bare) == (None, None, None)


def test_a_left_turn_lane_may_or_may_not_be_counted_in_a_coded_total():
    road = {"lanes_total": 3, "lanes_scope": "both_directions", "twltl": True}
    label = {"network": {"roads": [road], "layout_best": "t"}}
    assert compare(label, GeneratedCase(star({"a": 1, "b": 1, "c": 1}), {})) == {"lanes_total": 1.0, "legs": 1.0}
    road["twltl"] = False
    assert compare(label, GeneratedCase(star({"a": 1, "b": 1, "c": 1}), {}))["lanes_total"] == 0.0


def test_sides_are_told_apart_and_other_actors_overlooked():
    touch = first_touch({k: v for k, v in CRASH.items() if k.startswith("V")})
    assert touch.areas == {"V1": "front", "V2": "left"}
    assert first_touch({"V1": straight(0, 0, 0, 5), "V2": straight(0, 30, 0, 5)}) is None
    swapped = dict(LABEL, events=[dict(LABEL["events"][0], other_area="rear")])
    found = compare(swapped, RIGHT)
    assert (found["collision_pair"], found["collision_areas"]) == (1.0, 0.0)


# ------------------------------------------------------------------ against the public scorer
def scorer():
    spec = importlib.util.spec_from_file_location("public_scorer", SCORER)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def random_run(folder, draw):
    """A run folder with a random network of a few nodes and random motion of a few actors."""
    folder.mkdir()
    nodes = [f"n{i}" for i in range(draw.integers(2, 6))]
    edges = {tuple(draw.choice(nodes, 2)) for _ in range(draw.integers(2, 9))}
    edges |= {(b, a) for a, b in edges if draw.random() < 0.8}
    lane = '<lane id="l" index="0" {}speed="9" length="9" shape="0,0 9,0"/>'
    kinds = ['', '', 'allow="bicycle" ', 'disallow="passenger" ']  # fmt: skip
    body = ""
    for k, (a, b) in enumerate(sorted(edges)):
        lanes = "".join(lane.format(draw.choice(kinds)) for _ in range(draw.integers(1, 4)))
        body += f'<edge id="{k}" from="{a}" to="{b}">{lanes}</edge>'
    (folder / "road.net.xml").write_text(f'<net><edge id=":x" function="internal">{lane.format("")}</edge>{body}</net>')
    actors = [f"V{k}" for k in range(1, draw.integers(2, 5))] + ["O1"]
    with (folder / "trajectories.csv").open("w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(["t_s", "actor", "x_m", "y_m", "heading_rad", "speed_mps"])
        for actor in actors:
            (x, y), heading, speed = draw.uniform(-25, 25, 2), draw.uniform(-3.2, 3.2), draw.choice([0, 5, 12])
            turn = draw.choice([0.0, 0.15, -0.15])
            for k in range(70):
                writer.writerow([f"{k * 0.05:.2f}", actor, f"{x:.6f}", f"{y:.6f}", f"{heading:.7f}", speed])
                heading += turn * 0.05 * speed / 5
                x, y = x + 0.05 * speed * np.cos(heading), y + 0.05 * speed * np.sin(heading)
    status = "generated" if draw.random() < 0.9 else "exhausted"
    sizes = [{"id": a, "length_m": 4.7, "width_m": 1.8} for a in actors]
    (folder / "result.json").write_text(json.dumps({"status": status, "actors": sizes}))


@pytest.mark.skipif(not LABELS.is_dir() or not SCORER.is_file(), reason="the real labels are not here")
def test_every_figure_is_the_public_scorers_to_the_digit(tmp_path):
    from flows.results.reading import made_of

    draw, public = np.random.default_rng(11), scorer()
    labels = sorted(LABELS.glob("ciren*.json"))[:27] + sorted(LABELS.glob("nmvccs*.json"))[:40]
    for file in labels:
        label = json.loads(file.read_text())
        random_run(tmp_path / file.stem, draw)
        theirs = public.score_case(tmp_path / file.stem, label)
        result = json.loads((tmp_path / file.stem / "result.json").read_text())
        ours = compare(label, made_of(tmp_path / file.stem, result))
        shared = {k: v for k, v in ours.items() if not k.endswith("error_any") and not k.startswith("segment")}
        assert {THEIRS.get(k, k): v for k, v in shared.items()} == {
            k: v for k, v in theirs.items() if k not in ("generated", "intersections_exact", "lanes_exact")
        }, file.stem
        if "intersections_exact" in theirs:
            assert ours["intersection_count_error_any"] == 1 - theirs["intersections_exact"]


def test_lanes_are_counted_as_the_whole_reader_counts_them():
    net = """<net><edge id="a" from="x" to="y"><lane id="a_0" index="0" allow="passenger bus" speed="9" length="9"
    shape="0,0 9,0"/><lane id="a_1" index="1" disallow="passenger" speed="9" length="9" shape="0,3 9,3"/></edge>
    </net>"""
    assert lanes_between(net) == {("x", "y"): 1}


@pytest.mark.parametrize(("kind", "moved_m", "turned_deg", "verdict"), [
    ("stopped", 1.9, 0.0, True), ("parked", 2.0, 0.0, False), ("straight", 2.0, 29.0, True),
    ("straight", 9.0, -31.0, False), ("turn_left", 9.0, 12.1, True), ("turn_left", 9.0, -12.1, False),
    ("turn_right", 9.0, -12.1, True), ("u_turn", 9.0, -90.0, False), ("merge", 9.0, 0.0, None), (None, 0.0, 0.0, None),
])  # fmt: skip
def test_a_way_and_a_turn_show_a_maneuver(
    kind: str | None, moved_m: float, turned_deg: float, verdict: bool | None
) -> None:
    assert maneuver_shown(kind, moved_m, turned_deg) is verdict


@pytest.mark.parametrize(
    ("kind", "stood_s", "way"), [("stopped", 1.2, 0.0), ("stopped", 0.0, 5.0), ("parked", 1.2, 15.0)]
)
def test_of_a_stop_only_the_time_counts_in_which_it_stood(kind: str, stood_s: float, way: float) -> None:
    t_s = np.arange(0.0, 3.01, 0.05) + 0.0
    t_s = np.append(t_s, t_s[-1] + stood_s) if stood_s else t_s
    x_m = np.minimum(5.0 * t_s, 15.0)
    assert way_m(kind, np.column_stack((x_m, 0 * x_m, 0 * x_m)), t_s) == pytest.approx(way, abs=0.3)
