"""Symbols of drawn actors: kinds differ at the size that the model sees, small ones have their names beside them."""

import math
from itertools import combinations
from random import Random

import numpy as np
import pytest

from plugins.backbone.mini.drawing_view import look
from research.generator.crash.world import Actor
from research.renderer import icons
from research.renderer.boxes import Pose, corners
from research.renderer.pen import Pen
from research.renderer.poses import Track
from sgcad_core.kinds import ACTORS

SCALE = 6.0
TWO_WHEELS = [r.id for r in ACTORS.values() if r.ridden and r.learned]
KINDS = ("car", "truck", "bus", "motorcycle", "bicycle", "pedestrian", "object")


def drawn(kind: str, heading: float = 0.0, label: bool = False) -> Pen:
    pen = Pen(Random(0), 120, 120, SCALE, 0.0, (0.0, 0.0))
    name = {"pedestrian": "P1", "bicycle": "B1", "object": "O1"}.get(kind, "V2")
    track = Track(Actor(name, kind, 0, 4, "straight"), ACTORS[kind].drawn_m)
    look = icons.Look("plain", label)
    icons.vehicle(Random(0), pen, track, Pose(0.0, 0.0, heading), (150, 150, 150), look)
    return pen


@pytest.mark.parametrize(("one", "other"), list(combinations(KINDS, 2)))
def test_kinds_are_told_apart_at_the_size_that_the_model_sees(one: str, other: str) -> None:
    sheets = [drawn(kind).image.resize((80, 80)) for kind in (one, other)]
    ink = [255.0 - np.asarray(sheet.convert("L"), float) for sheet in sheets]
    assert np.abs(ink[0] - ink[1]).sum() > 0.25 * max(part.sum() for part in ink)


@pytest.mark.parametrize("kind", TWO_WHEELS)
@pytest.mark.parametrize("heading", [0.0, 1.0, math.pi / 2, 4.0])
def test_the_name_of_a_small_vehicle_stands_beside_it(kind: str, heading: float) -> None:
    bare, named = (np.asarray(drawn(kind, heading, label).image.convert("L"), int) for label in (False, True))
    added = np.argwhere(bare != named)[:, ::-1]
    box = Pen(Random(0), 120, 120, SCALE, 0.0, (0.0, 0.0)).px(corners(Pose(0.0, 0.0, heading), ACTORS[kind].drawn_m))
    middle, inner = box.mean(axis=0), ACTORS[kind].drawn_m[1] * SCALE / 2
    away = np.hypot(*(added - middle).T)
    assert len(added) > 20
    assert away.min() > inner
    assert away.max() < 60


@pytest.mark.parametrize("kind", [*TWO_WHEELS, "truck", "bus"])
@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_a_symbol_shows_which_way_it_faces(kind: str, heading: float) -> None:
    ink = [255.0 - np.asarray(drawn(kind, turn).image.convert("L"), float) for turn in (heading, heading + math.pi)]
    assert np.abs(ink[0] - ink[1]).sum() > 0.08 * ink[0].sum()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("turn", [0.0, 0.5, math.pi / 2])
def test_a_symbol_lies_where_its_box_lies_on_a_turned_sheet(kind: str, turn: float) -> None:
    pen = Pen(Random(0), 160, 160, SCALE, turn, (0.0, 0.0))
    pose, track = Pose(4.0, 3.0, 0.7), Track(Actor("V2", kind, 0, 4, "straight"), ACTORS[kind].drawn_m)
    icons.vehicle(Random(0), pen, track, pose, (150, 150, 150), icons.Look("plain", label=False))
    ink = np.argwhere(np.asarray(pen.image.convert("L")) < 250)[:, ::-1]
    assert np.abs(ink.mean(axis=0) - pen.px(np.array([(pose.x, pose.y)]))[0]).max() < 8


def test_two_that_differ_only_in_kind_stay_apart_on_the_sheet() -> None:
    sheets = [look(drawn(kind, 0.7).image)[0].astype(int) for kind in TWO_WHEELS]
    assert np.abs(sheets[0] - sheets[1]).mean() > 5
