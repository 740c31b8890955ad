"""Studies written by hand as `sgcad study` leaves them: study.json and case folders, small but whole."""

import json

import numpy as np
import pytest

from flows.results.reading import load_study
from flows.results.table import tables_of

NET = """<net>
<edge id="a" from="w" to="m"><lane id="a_0" index="0" speed="13.9" length="100" shape="-100,-1.6 0,-1.6"/></edge>
<edge id="-a" from="m" to="w"><lane id="-a_0" index="0" speed="13.9" length="100" shape="0,1.6 -100,1.6"/></edge>
<edge id="b" from="m" to="e"><lane id="b_0" index="0" speed="13.9" length="100" shape="8,-1.6 100,-1.6"/></edge>
<edge id="-b" from="e" to="m"><lane id="-b_0" index="0" speed="13.9" length="100" shape="100,1.6 8,1.6"/></edge>
<edge id="c" from="m" to="s"><lane id="c_0" index="0" speed="13.9" length="100" shape="3,-4 3,-100"/></edge>
<edge id="-c" from="s" to="m"><lane id="-c_0" index="0" speed="13.9" length="100" shape="6,-100 6,-4"/></edge>
<junction id="w" type="dead_end" x="-100" y="0" shape="-100,0 -100,-3.2"/>
<junction id="m" type="priority" x="4" y="0" shape="0,3.2 0,-4 8,-4 8,3.2"/>
<junction id="e" type="dead_end" x="100" y="0" shape="100,0 100,-3.2"/>
<junction id="s" type="dead_end" x="4" y="-100" shape="0,-100 8,-100"/>
<connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
</net>"""
WIDE = NET.replace(
    '<lane id="a_0"', '<lane id="a_1" index="1" speed="9" length="99" shape="-100,-4 0,-4"/><lane id="a_0"'
)
LABEL = {
    "network": {
        "nodes": [{"id": n, "x": x, "y": y} for n, x, y in (("J", 50, 50), ("w", 0, 50), ("e", 99, 50), ("s", 50, 99))],
        "segments": [
            {"from": n, "to": "J", "lanes_towards_to": 1, "lanes_towards_from": 1} for n in ("w", "e", "s")
        ],
        "intersections": 1,
        "components": 1,
    },
    "vehicles": [{"id": "V1", "initial_heading": "E", "manoeuvre": "straight"}, {"id": "V2", "manoeuvre": "stopped"}],
    "events": [{"kind": "collision", "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "rear"}],
}  # fmt: skip
CAR = {"type": "car", "length_m": 4.6, "width_m": 1.8, "maneuver": "straight"}
STORY = "V1 was traveling east on a two-lane road. V2 was stopped ahead. The front of V1 struck the rear of V2."


LACKING = {"kind": "lacks", "text": "contact 2: V2 strikes V3", "reason": "the two do not touch"}
ACCOUNT = {"verdict": "lacking", "told": 5, "has": 4, "lacking": 1, "assumed": 3, "items": [LACKING]}


PLACES = {sentence: (at := STORY.index(sentence), at + len(sentence)) for sentence in (
    "V1 was traveling east on a two-lane road.", "V2 was stopped ahead.", "The front of V1 struck the rear of V2.",
)}  # fmt: skip
"""[start, end) of the sentences of STORY."""


def with_marks(told):
    """A result whose first sentence was read, whose second one is contradicted, and whose last one is unread."""
    first, second, last = (dict(zip(("start", "end"), place, strict=True)) for place in PLACES.values())
    items = [{"kind": "contradicts", "text": "", **second}, {"kind": "unread", "text": "", **last}]
    facts = [{"field": "vehicles.V1.heading", **first}, {"field": "vehicles.V2.maneuver", **second}]
    return told | {"facts": facts, "account": told["account"] | {"items": [*told["account"]["items"], *items]}}


def result(case, arm, status="generated", realised=True):
    observed = {"actor": "V1", "other": "V2", "actor_area": "front", "other_area": "back", "t_s": 1.6}
    declared = {"striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "back"}
    made = status == "generated"
    return {
        "case": case, "config": arm, "status": status, "reason": "" if made else f"road: {status} for a reason",
        "missing": [], "attempts": {"road": 1, "scenario": int(made)},
        "network": {"intersections": 1, "components": 1, "mean_lanes": 1.0, "segments": []} if made else None,
        "actors": [CAR | {"id": "V1"}, CAR | {"id": "V2"}] if made else [],
        "person": {"facts": 2, "disagreed": 1},
        "account": ACCOUNT if made else {"verdict": "none", "items": []},
        "collision": {"declared": declared if made else None, "realised": made and realised,
                      "observed": observed if made else None},
        "grounding": {}, "seconds": {"road": 0.1}, "notes": [],
    }  # fmt: skip


def write_case(folder, status="generated", net=NET, realised=True, story=STORY, ttc=0.5, faults=(), marked=False):
    """One finished case; `faults` are the sources of the findings of its road attempt."""
    place = folder / "attempts" / "road-01"
    place.mkdir(parents=True, exist_ok=True)
    findings = [{"source": s, "what": "w", "where": "x", "value": "", "remedy": "r"} for s in faults]
    (place / "findings.json").write_text(json.dumps(findings))
    (folder / "report.txt").write_text(story)
    told = result(folder.name, folder.parent.name, status, realised)
    (folder / "result.json").write_text(json.dumps(with_marks(told) if marked else told))
    if status != "generated":
        return
    (folder / "road.net.xml").write_text(net)
    (folder / "player.html").write_text("<!doctype html>")
    rows = ["t_s,actor,x_m,y_m,heading_rad,speed_mps"]
    for t in np.arange(60) * 0.05:
        rows.append(f"{t:.2f},V1,{-20 + 10 * t:.3f},-1.6,0.0,10.0")
        rows.append(f"{t:.2f},V2,0.500,-1.6,0.0,0.0")
    (folder / "trajectories.csv").write_text("\n".join(rows) + "\n")
    figures = {
        "collision_probability": 0.4, "near_miss_probability": 0.5, "time_to_collision_s": ttc, "minimum_distance_m": 1,
        "interaction_intensity_mean": 0.1, "post_encroachment_time_s": None, "average_displacement_error_m": 1.0,
        "final_displacement_error_m": 2.0, "emergency_level": "critical", "collision": True, "collision_speed_mps": 10,
    }  # fmt: skip
    exact = figures | {
        "emergency_level": "high", "ttc_1_s_before_s": 0.9, "drac_1_s_before_mps2": 5.0, "time_exposed_ttc_s": 1.4,
        "delta_v_worst_mps": 6.0, "fatality_risk": 0.01, "brake_by_s": {"V1": 1.1, "V2": None},
        "steer_by_s": {"V1": 0.8},
    }  # fmt: skip
    driven = {"avoided": 1, "mitigated": 0, "unchanged": 0, "worse": 0, "lost": 0, "failed": 0}
    drive = {"reference": {"initiator": driven, "responder": driven | {"avoided": 0, "mitigated": 1}}}
    (folder / "metrics.json").write_text(json.dumps({"paper": figures, "exact": exact, "drive": drive}))


@pytest.fixture
def study(tmp_path):
    """`study({"a": {"c1": {}, "c2": {"status": "refused"}}, "b": {...}}, about={...})` -> its folder."""

    def write(runs, about=None, arms=None, truth=True, cases=None):
        folder = tmp_path / "runs" / "studies" / "kit"
        names = list(cases or dict.fromkeys(c for finished in runs.values() for c in finished))
        labels = tmp_path / "truth"
        labels.mkdir(exist_ok=True)
        for case in names if truth else ():
            (labels / f"{case}.json").write_text(json.dumps(LABEL))
        for arm, finished in runs.items():
            for case, changes in finished.items():
                write_case(folder / arm / case, **changes)
        listed = [{"name": a, "label": a.upper(), "config": "x.yaml", "set": [], "published": None} for a in runs]
        listed = [one | (arms or {}).get(one["name"], {}) for one in listed]
        content = {"study": "kit", "title": "Kit", "reference": None, "truth": str(labels) if truth else None,
                   "cases": names, "arms": listed, "package": "0.1.0", "hardware": {"cores": 2}}  # fmt: skip
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "study.json").write_text(json.dumps(content | (about or {})))
        return folder

    return write


@pytest.fixture
def tables(study):
    """The same, read and made into tables."""

    def make(*args, **more):
        return tables_of(load_study(study(*args, **more)))

    return make
