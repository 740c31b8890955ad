"""Second contacts of two tracks: that they come about, and the sides on which they do."""

from __future__ import annotations

import numpy as np

from sgcad_core.planner.aftermath.second_contact import NOT_AGAIN, WRONG_SIDE, missed_again, wrong_sides
from sgcad_core.planner.aftermath.struck_objects import standing_track
from sgcad_core.planner.scene import Scene
from sgcad_core.records.specs import Actor, Area

CAR = (4.7, 1.8)
PAIR = frozenset(("V1", "V2"))
AHEAD, BESIDE, APART = (4.68, 0.0), (0.5, 1.78), (0.0, 9.0)


def cost(places: list[tuple[float, float]], own: Area, other: Area) -> float:
    """The cost where V2 is at each of some places beside V1 for half a second."""
    scene = Scene(10 * len(places), 0)
    for name in ("V1", "V2"):
        actor = Actor(id=name, kind="car", road="W", direction="forward", maneuver="stopped")
        scene.tracks[name] = standing_track(scene, actor, np.zeros(3))
    scene.tracks["V2"].poses = np.repeat([[x, y, 0.0] for x, y in places], 10, axis=0)
    scene.sides[PAIR] = {"V1": own, "V2": other}
    return missed_again(scene, PAIR)


def test_one_contact_is_no_second_one() -> None:
    assert cost([APART, AHEAD, APART], "front", "back") == NOT_AGAIN


def test_a_second_contact_is_judged_by_its_sides() -> None:
    places = [APART, AHEAD, APART, BESIDE]
    assert cost(places, "left", "right") == 0.0
    assert cost(places, "left", "front") == WRONG_SIDE
    assert cost(places, "front", "back") == 2 * WRONG_SIDE


def test_boxes_that_do_not_overlap_have_no_wrong_side() -> None:
    one, far = np.zeros((2, 3)), np.array([[*BESIDE, 0.0], [*APART, 0.0]])
    assert wrong_sides((one, CAR), (far, CAR), ("front", "right")).tolist() == [1, 0]
