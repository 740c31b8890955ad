"""Turning drawings upright: points go where pixels go, lessons name the turn, the shipped network finds north."""

from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from plugins.backbone.mini import north_arrow
from plugins.backbone.mini.drawing_view import quarters_of, turn_points, turn_upright
from research.generator.report import make_report
from research.renderer.draw import draw_labeled
from research.training.train_north import _best, accuracy, lesson, loss_of, train

WEIGHTS = Path(__file__).parents[4] / "plugins" / "backbone" / "mini" / "weights"


@given(
    width=st.integers(3, 30), height=st.integers(3, 30), quarters=st.integers(0, 3), x=st.integers(0, 29),
    y=st.integers(0, 29),
)  # fmt: skip
def test_points_go_where_pixels_go(width: int, height: int, quarters: int, x: int, y: int) -> None:
    x, y = x % width, y % height
    image = Image.new("L", (width, height))
    image.putpixel((x, y), 255)
    found = turn_points(np.array([[x + 0.5, y + 0.5]]), image.size, quarters)[0]
    assert turn_upright(image, quarters).getpixel((int(found[0]), int(found[1]))) == 255


@pytest.mark.parametrize(("turn", "quarters"), [(0.0, 0), (1.5, 1), (-1.5, 3), (3.1, 2), (-3.1, 2), (0.6, 0)])
def test_quarters_are_the_nearest(turn: float, quarters: int) -> None:
    assert quarters_of(turn) == quarters


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), turned=st.integers(0, 3))
def test_a_lesson_names_the_turn_of_the_turned_drawing(seed: int, turned: int) -> None:
    drawing = draw_labeled(make_report(seed, modes={"image": 1.0}))
    ink, wanted = lesson(drawing, turned)
    assert ink.shape == (north_arrow.SHEET, north_arrow.SHEET)
    classes = set(wanted[wanted >= 0].tolist()) - {4}
    assert classes <= {(quarters_of(drawing.turn) - turned) % 4}


def test_a_few_steps_of_training_lower_the_loss(tmp_path: Path) -> None:
    torch.manual_seed(0)
    sheets, wanted = zip(
        *(lesson(draw_labeled(make_report(s, modes={"image": 1.0})), s % 4) for s in range(6)), strict=True
    )
    ink, classes = torch.from_numpy(np.stack(sheets)), torch.from_numpy(np.stack(wanted))
    before = float(loss_of(north_arrow.NorthFinder(), ink, classes).detach())
    found = train(tmp_path, 1e4, batch=4, steps=10)
    assert int(found.seen) == 20
    assert float(loss_of(found.train(), ink, classes).detach()) < before
    again = north_arrow.load(tmp_path)
    assert again is not None
    assert torch.equal(again.layers[0].weight, found.layers[0].weight)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_best_place_is_asked_among_all_of_its_sheet(seed: int) -> None:
    torch.manual_seed(seed)
    logits, wanted = torch.randn(2, 5, 6, 6), torch.full((2, 6, 6), 4)
    wanted[0, 1:4, 1:4] = -1
    wanted[0, 2, 2] = 3  # an arrow turned by three quarters, and the places too near to tell
    every, right = torch.ones(()), torch.zeros(())
    for quarter in range(4):
        odds = (logits[0, quarter] - logits[0, 4]).exp()
        near = wanted[0] == -1 if quarter == 3 else torch.zeros(6, 6, dtype=torch.bool)
        every = every + odds[~near].sum()
        right = odds[2, 2] if quarter == 3 else right
    none = -torch.log(1 / (1 + (logits[1, :4] - logits[1, 4:]).exp().sum()))
    assert torch.allclose(_best(logits, wanted), (none - torch.log(right / every)) / 2, atol=1e-4)


def test_a_drawing_without_an_arrow_counts_as_upright() -> None:
    finder = north_arrow.NorthFinder().eval()
    for scores, quarters in (((-9.0, -3.0, -9.0, -9.0), 0), ((-9.0, 6.0, -9.0, 1.0), 1), ((1.0, 2.0, -9.0, -9.0), 0)):
        finder.scores = lambda _, found=scores: torch.tensor([found])  # type: ignore[method-assign]
        assert finder.quarters(Image.new("RGB", (40, 30), "white")) == quarters


def test_a_folder_without_the_network_is_no_fault(tmp_path: Path) -> None:
    assert north_arrow.load(tmp_path) is None


def test_an_empty_sheet_stays_as_it_is() -> None:
    image = Image.new("RGB", (40, 30), "white")
    finder = north_arrow.NorthFinder()
    finder.eval()
    torch.nn.init.zeros_(finder.layers[-1].weight)
    torch.nn.init.zeros_(finder.layers[-1].bias)
    assert finder.upright(image) is image


@pytest.mark.slow
def test_the_shipped_network_turns_made_drawings_upright() -> None:
    finder = north_arrow.load(WEIGHTS)
    assert finder is not None
    assert accuracy(finder, 200) > 0.9
