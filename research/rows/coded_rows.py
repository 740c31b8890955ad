"""Training rows of a pool of coded incident reports: what their codes allow, narrowed by the rules where they agree.

    python -m research.rows.coded_rows POOL.jsonl --out ROWS.jsonl [--part train|validation]

`python -m research.training.train --told ROWS.jsonl` learns from them; the form of a row is
`research.rows.partial_labels.load`'s. Blind reports (research/rows/coded_incidents.py) never become rows; those
whose hash leaves 1 are for validation. A code allows a set of values: any side of the flagged areas, any way to go
straight on. Where the rules read one of that set outright, that one is trained; where they read another one, the code
stands. What no code says is not trained, whatever the rules say. The rows hold the reports' texts: they are made anew
wherever one trains, and never kept with the code.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from research.rows.coded_incidents import BLIND_OF, Incident, by_hash, of_pool
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.seven_question_gist import rule_values

VALIDATION = 1
"""Remainder of the hash of an id, of `BLIND_OF`; 0 is blind."""
WAYS: Mapping[str, tuple[str, ...]] = {
    "stopped": ("stopped",),
    "parked": ("parked",),
    "straight": ("straight", "slowing", "negotiating_curve"),
    "starting": ("straight",),
    "backing": ("backing",),
    "turn_left": ("turn_left",),
    "turn_right": ("turn_right",),
    "u_turn": ("u_turn",),
    "lane_change": ("lane_change_left", "lane_change_right", "merge"),
    "passing": ("overtaking", "lane_change_left", "lane_change_right", "straight"),
    "crossing_centerline": ("crossing_centerline",),
    "departure": ("departing_road_left", "departing_road_right"),
}
"""Maneuvers that a code allows; of other codes nothing is trained."""
MET: Mapping[str, tuple[str, ...]] = {
    "vehicle": ("car", "suv", "van", "pickup"),
    "truck": ("truck", "pickup", "trailer"),
    "bus": ("bus",),
    "motorcycle": ("motorcycle",),
    "pedestrian": ("pedestrian",),
    "cyclist": ("bicycle",),
    "animal": ("object",),
    "object": ("object",),
}
OPEN_ROAD = ("Street", "Non-Junction", "Highway / Freeway")
"""Places coded as none of a junction, which the codes' writers take less strictly than a junction itself."""
OPEN_ROAD_WEIGHT = 0.3


def allowed(truth: Mapping[str, Any]) -> dict[str, tuple[Any, ...]]:
    """Field of the gist -> values that the codes of a report allow; fields that no code speaks of are left out."""
    subject, other, road = truth["subject"], truth["other"], truth["road"]
    found: dict[str, tuple[Any, ...]] = {
        "touched": (bool(truth["contact"]),),
        "met": MET.get(other["kind"], ()),
        "subject": WAYS.get(subject["manoeuvre"], ()),
        "other": WAYS.get(other["manoeuvre"], ()) if other["kind"] not in ("animal", "object") else (),
        "subject_area": _sides(subject["areas"]),
        "other_area": _sides(other["areas"]) if other["kind"] != "object" else (),
        "junction": (True,) if road.get("intersection") else (False,) if road.get("kind") in OPEN_ROAD else (),
    }
    return {key: values for key, values in found.items() if values}


def _sides(codes: list[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(side for code in codes for side in code.split("_")))


def row(incident: Incident) -> dict[str, Any]:
    """A report as a row: sets of the codes, narrowed to what the text tells outright in the rules' reading."""
    values, told = rule_values(read(incident.text))
    sets = {
        key: (values[key],) if key in told and values[key] in some else some
        for key, some in allowed(incident.truth).items()
    }
    weight = {"junction": OPEN_ROAD_WEIGHT} if sets.get("junction") == (False,) else {}
    return {"id": incident.id, "text": incident.text, "allowed": sets, "weight": weight}


def incidents_of_part(pool: Path, part: str) -> Iterator[Incident]:
    """Reports of "train" or "validation"; never blind ones."""
    for incident in of_pool(pool):
        left = by_hash(incident.id) % BLIND_OF
        if incident.group == "seen" and (left == VALIDATION) == (part == "validation"):
            yield incident


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--part", choices=("train", "validation"), default="train")
    args = parser.parse_args(arguments)
    with args.out.open("w", encoding="utf-8") as file:
        for incident in incidents_of_part(args.pool, args.part):
            file.write(json.dumps(row(incident)) + "\n")


if __name__ == "__main__":
    main()
