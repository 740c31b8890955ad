"""Drawings: reproducible, with touching boxes at the contact, and readable at the size that the model sees."""

import math
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from plugins.backbone.mini import drawing_view
from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Access, Actor, Crash, Leg
from research.generator.report import make_report
from research.generator.targets import drawn_facts
from research.renderer import accesses, traffic
from research.renderer.boxes import SIDE, Pose, corners, overlap, wrap
from research.renderer.draw import _sheet, draw_report
from research.renderer.lines import Ground
from research.renderer.pen import Pen
from research.renderer.poses import Stage, Track
from research.renderer.road_marks import RoadMarks

seeds = st.integers(0, 10**6)


@settings(max_examples=25, deadline=None)
@given(seed=seeds)
def test_a_seed_is_one_drawing(seed: int) -> None:
    report = make_report(seed, modes={"image": 1.0})
    assert draw_report(report).tobytes() == draw_report(report).tobytes()


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_the_two_of_the_first_contact_touch(seed: int) -> None:
    crash = sample_crash(Random(seed))
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0)
    tracks = {track.actor.id: track for track in Stage(Random(seed), crash, ground, 1.0).tracks()}
    contact = crash.contacts[0]
    boxes = [tracks[crash.actors[i].id] for i in (contact.striker, contact.struck)]
    one, two = (corners(track.poses[track.contact], track.size) for track in boxes)
    gap = min(math.dist(p, q) for p in _edge(one) for q in _edge(two))
    assert gap < 1.2


def _edge(box: np.ndarray) -> list[tuple[float, float]]:
    shares = np.linspace(0, 1, 9)[:, None]
    return [tuple(p) for a, b in zip(box, np.roll(box, -1, axis=0), strict=True) for p in a + (b - a) * shares]


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_the_sides_at_the_contact_face_each_other(seed: int) -> None:
    crash = sample_crash(Random(seed))
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0)
    tracks = {track.actor.id: track for track in Stage(Random(seed), crash, ground, 1.0).tracks()}
    contact = crash.contacts[0]
    normals = []
    for index, area in ((contact.striker, contact.striker_area), (contact.struck, contact.struck_area)):
        track = tracks[crash.actors[index].id]
        normals.append(track.poses[track.contact].heading + SIDE[area])
    assert abs(wrap(normals[0] - normals[1] - math.pi)) < math.radians(50)


def test_first_vehicles_are_red_in_most_drawings() -> None:
    red = 0
    for seed in range(40):
        pixels = np.asarray(draw_report(make_report(seed, modes={"image": 1.0})), int)
        red += bool(((pixels[..., 0] > 150) & (pixels[..., 1] < 90)).sum() > 40)
    assert red >= 28


def test_a_thin_line_stays_visible() -> None:
    image = Image.new("RGB", (1300, 1300), "white")
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 0, 1299, 1299), outline=(0, 0, 0))
    draw.line((650, 0, 650, 1299), fill=(0, 0, 0), width=1)
    sheet, grid = drawing_view.look(image)
    middle = grid[1] * drawing_view.PATCH // 2
    around = sheet[0, 100, middle - 6 : middle + 6].astype(int)
    assert around.max() - around.min() > 255 / 3


@pytest.mark.parametrize(("size", "grid"), [((1300, 310), (8, 32)), ((500, 520), (16, 16)), ((300, 1200), (32, 8))])
def test_grids_follow_the_shape(size: tuple[int, int], grid: tuple[int, int]) -> None:
    image = Image.new("RGB", size, "white")
    ImageDraw.Draw(image).rectangle((0, 0, size[0] - 1, size[1] - 1), outline=(0, 0, 0))
    assert drawing_view.look(image)[1] == grid


def test_an_empty_sheet_is_no_fault() -> None:
    sheet, grid = drawing_view.look(Image.new("RGB", (50, 40), "white"))
    assert sheet.shape == (3, grid[0] * drawing_view.PATCH, grid[1] * drawing_view.PATCH)
    assert not sheet.any()


@settings(max_examples=60, deadline=None)
@given(width=st.integers(60, 1400), height=st.integers(60, 1400), view=st.integers(0, len(drawing_view.VIEWS) - 1))
def test_every_view_lies_on_its_sheet(width: int, height: int, view: int) -> None:
    image = Image.new("RGB", (width, height), "white")
    ImageDraw.Draw(image).rectangle((5, 5, width - 6, height - 6), outline="black", width=3)
    laid, plain = drawing_view.fit(image, view), drawing_view.fit(image)
    assert laid.grid == plain.grid
    sheet = np.array([laid.grid[1], laid.grid[0]]) * drawing_view.PATCH
    edges = laid(np.array([laid.box[:2], laid.box[2:]], np.float64))
    assert (edges >= -1).all()
    assert (edges <= sheet + 1).all()
    assert laid.scale <= plain.scale


def test_views_show_the_same_ink_elsewhere() -> None:
    image = draw_report(make_report(5, modes={"image": 1.0}))
    sheets = [drawing_view.look(image, view)[0].astype(float) for view in range(len(drawing_view.VIEWS))]
    for i, one in enumerate(sheets):
        assert 0.7 < one.sum() / sheets[0].sum() < 1.1
        assert all(np.abs(one - other).mean() > 1 for other in sheets[:i])


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_nothing_that_came_later_hides_how_an_actor_came(seed: int) -> None:
    crash = sample_crash(Random(seed))
    ground = Ground(crash, {leg.bearing: 50.0 for leg in crash.legs}, 100.0)
    tracks = Stage(Random(seed), crash, ground, 1.2).tracks()
    for track in tracks:
        for other in tracks:
            later = track.poses[track.contact + 1 :] if other is not track else []
            came = other.poses[: other.contact + 1]
            assert not any(overlap(a, track.size, b, other.size) for a in later for b in came)


@settings(deadline=None)
@given(x=st.floats(-20, 20), y=st.floats(-20, 20), one=st.floats(-3.2, 3.2), two=st.floats(-3.2, 3.2))
def test_boxes_overlap_where_they_share_points(x: float, y: float, one: float, two: float) -> None:
    first, second, size, other = Pose(0, 0, one), Pose(x, y, two), (4.8, 2.0), (13.0, 2.7)
    found = overlap(first, size, second, other)
    assert found == overlap(second, other, first, size)
    # The boxes share ground where a point of the one lies in the other, or where their sides cross.
    shrunk = [(w - 0.2, h - 0.2) for w, h in (size, other)]
    assert found or not _share(first, shrunk[0], second, shrunk[1])
    grown = [(w + 0.3, h + 0.3) for w, h in (size, other)]
    assert not found or _share(first, grown[0], second, grown[1])


def _share(first: Pose, size: tuple[float, float], second: Pose, other: tuple[float, float]) -> bool:
    """By a dense grid of points of the one box that are looked for in the other."""
    grid = np.stack(np.meshgrid(np.linspace(-0.5, 0.5, 61), np.linspace(-0.5, 0.5, 31)), -1).reshape(-1, 2) * size
    c, s = math.cos(first.heading), math.sin(first.heading)
    points = grid @ np.array([(c, s), (-s, c)]) + (first.x - second.x, first.y - second.y)
    c, s = math.cos(second.heading), math.sin(second.heading)
    return bool((np.abs(points @ np.array([(c, -s), (s, c)])) <= np.array(other) / 2).all(axis=1).any())


@pytest.mark.parametrize("seed", range(40))
def test_arrows_of_one_way_streets_point_along_their_traffic(seed: int) -> None:
    crash = sample_crash(Random(seed))
    for leg in crash.legs:
        leg.turns_in = []
        if leg.bearing % 4 == crash.main % 4:
            inward = leg.bearing == crash.main
            leg.lanes_in, leg.lanes_out, leg.twltl, leg.kind = 2 * inward, 2 * (not inward), False, "road"
    ground = Ground(crash, {leg.bearing: 60.0 for leg in crash.legs}, 100.0)
    pen = Pen(Random(seed), 400, 400, 3.0, 0.0, (0.0, 0.0))
    marks, arrows = RoadMarks(Random(seed), pen, crash, ground), []
    marks._painted = arrows.append  # type: ignore[method-assign]
    band = ground.bands[crash.main]
    for _ in range(8 if ground.plain else 1):
        marks._one_way(band, ground.setback(crash.main, 1.0), arrows=False)
    hub = pen.px(np.array([(0.0, 0.0)]))[0]
    assert len(arrows) >= 2
    for tail, tip in arrows:
        assert math.dist(tip, hub) < math.dist(tail, hub)
    away = ground.bands.get((crash.main + 4) % 8)
    if away is not None and not ground.plain:
        arrows.clear()
        marks._one_way(away, ground.setback(away.leg.bearing, 1.0), arrows=False)
        assert all(math.dist(tip, hub) > math.dist(tail, hub) for tail, tip in arrows)
        assert len(arrows) == 2


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_every_leg_is_seen_beyond_the_junction(seed: int) -> None:
    report = make_report(seed, modes={"image": 1.0})
    _, ground = _sheet(Random(seed), report.crash)
    for bearing, band in ground.bands.items():
        assert band.length >= ground.setback(bearing, 1.0) + (11.9 if band.leg.mouth is None else band.leg.mouth)


def _ink(shape: np.ndarray, pen: Pen) -> np.ndarray:
    """Dark pixels within a shape of world points, as a mask of the sheet."""
    inside = Image.new("1", pen.image.size)
    ImageDraw.Draw(inside).polygon([tuple(p) for p in pen.px(shape)], fill=1)
    return np.asarray(inside) & (np.asarray(pen.image.convert("L")) < 128)


@settings(max_examples=60, deadline=None)
@given(seed=seeds, leg=st.sampled_from((0, 4)), side=st.sampled_from(("left", "right")), mouth=st.floats(1.5, 14.0))
def test_a_driveway_opens_the_curb_and_its_mouth_is_open(seed: int, leg: int, side: str, mouth: float) -> None:
    access = Access(leg, side, 40, "driveway", mouth)
    crash = Crash("rear_end", "plain", 0, [Leg(0, 1, 1), Leg(4, 1, 1)], [], [], "day", "clear", "dry", [access])
    ground = Ground(crash, {0: 30.0, 4: 30.0}, 100.0)
    pen = Pen(Random(seed), 500, 500, 8.0, 0.0, (0.0, 0.0))
    marks = RoadMarks(Random(seed), pen, crash, ground)
    marks.draw(arrows=False, signs=False)
    assert pen.shows(accesses.box(pen, ground, access, 0.5, 1.0), 0.0)
    assert _ink(accesses.box(pen, ground, access, 0.3, mouth, wider=-1.9), pen).sum() == 0
    assert _ink(accesses.box(pen, ground, access, 0.1, mouth, wider=1.2), pen).any()
    assert _ink(accesses.box(pen, ground, access, mouth + 0.5, mouth + 9.0, wider=1.0), pen).sum() == 0


@settings(max_examples=100, deadline=None)
@given(seed=seeds)
def test_a_drawing_claims_no_maneuver_and_no_exit_that_nobody_could_see(seed: int) -> None:
    crash = sample_crash(Random(seed))
    facts = drawn_facts(crash, True, True, False)
    for actor in crash.actors:
        alone = sum(other.leg == actor.leg for other in crash.actors) < 2
        unseen = actor.maneuver == "slowing" or (actor.maneuver == "overtaking" and alone)
        assert (f"man.{actor.id}" in facts) == (not unseen)
        assert (f"exit.{actor.id}" in facts) == (not actor.meant)


def test_stop_bars_are_drawn_only_where_the_control_is() -> None:
    legs = [Leg(bearing, 1, 1, control="stop") for bearing in (0, 2, 4, 6)]
    crash = Crash("crossing", "four", 0, legs, [], [], "day", "clear", "dry")
    bars = []
    for seed, signs in ((seed, signs) for seed in range(30) for signs in (True, False)):
        pen = Pen(Random(seed), 400, 400, 4.0, 0.0, (0.0, 0.0))
        marks = RoadMarks(Random(seed), pen, crash, Ground(crash, dict.fromkeys((0, 2, 4, 6), 40.0), 100.0))
        assert marks.stop_bars == RoadMarks(Random(seed), pen, crash, marks.ground).stop_bars
        lines: list[int] = []
        pen.line = lambda points, width=2, **_: lines.append(len(points) * (width == marks.mark + 2))  # type: ignore[method-assign]  # noqa: B023
        marks._signs = lambda: None  # type: ignore[method-assign]
        marks.draw(arrows=False, signs=signs)
        assert lines.count(2) == 4 * (signs and marks.stop_bars)
        bars.append(lines.count(2))
    assert max(bars) == 4


def test_arrows_between_poses_do_not_pass_through_others() -> None:
    pen = Pen(Random(0), 400, 400, 4.0, 0.0, (0.0, 0.0))
    one = Track(Actor("V1", "car", 6, 2, "straight"), (4.8, 2.0), [Pose(-30, 0, 0.0), Pose(30, 0, 0.0)], 1)
    blank = np.asarray(pen.image).copy()
    traffic._link(pen, one, 1, [one, Track(Actor("V2", "car", 0, 4, "straight"), (4.8, 2.0), [Pose(0, 1, 1.0)])])
    assert (np.asarray(pen.image) == blank).all()
    traffic._link(pen, one, 1, [one, Track(Actor("V2", "car", 0, 4, "straight"), (4.8, 2.0), [Pose(0, 9, 1.0)])])
    assert (np.asarray(pen.image) != blank).any()


def test_car_icons_have_places_of_rest_and_boxes_have_arrows() -> None:
    manners = [traffic.Manner.drawn(Random(seed)) for seed in range(600)]
    icons, boxes = ([m for m in manners if m.style == style] for style in ("icon", "box"))
    assert min(len(icons), len(boxes)) > 150
    assert np.mean([m.links for m in boxes]) > 0.7 > 0.4 > np.mean([m.links for m in icons])
    assert icons[0].rests > boxes[0].rests
    assert not any(m.dashed or m.ghosts for m in boxes)
    assert all(m.labels for m in manners if m.ghosts)
