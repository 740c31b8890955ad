"""Stages of a training: what each moves."""

from pathlib import Path

import pytest
import torch

from research.training.train import Trainer
from research.training.train_options import parse


@pytest.mark.slow
def test_the_stage_of_drawings_moves_only_the_eyes_and_another_run_takes_them(tmp_path: Path) -> None:
    usual = ["--size", "tiny", "--workers", "0", "--ranks", "1", "--texts", "100", "--tokens", "1500"]
    usual += ["--total-steps", "2", "--max-steps", "2", "--budget", "1000"]
    Trainer(parse([*usual, "--out", str(tmp_path / "a"), "--stage", "text"])).run()
    start = str(tmp_path / "a" / "export")
    eyes = Trainer(parse([*usual, "--out", str(tmp_path / "b"), "--stage", "pictures", "--start", start]))
    before = {key: value.detach().clone() for key, value in eyes.optimizer.master.items()}
    eyes.run()
    moved = {key for key, value in eyes.optimizer.master.items() if not torch.equal(value, before[key])}
    assert moved
    assert all(key.startswith(("model.visual.", "heads.picture.", "eye.")) for key in moved)
    joined = Trainer(
        parse([*usual, "--out", str(tmp_path / "c"), "--start", start, "--eyes", str(tmp_path / "b" / "export")])
    )
    for key, value in eyes.optimizer.master.items():
        if key.startswith(("model.visual.", "eye.")):
            assert torch.allclose(
                joined.optimizer.master[key], value, atol=0.01 * float(value.detach().abs().max()) + 1e-6
            )
