"""A training that is stopped or killed and called again: it ends with the weights of one that was left in peace."""

import random
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import torch

from research.rows import row_stream
from research.rows.row_stream import Feed, Place
from research.training import checkpoint
from research.training.train import Trainer
from research.training.train_options import parse
from sgcad_core import settings
from tests.research.trainings import options

torch.set_num_threads(1)


@pytest.mark.slow
def test_a_resumed_run_is_the_unbroken_run(tmp_path: Path) -> None:
    Trainer(parse(options(tmp_path / "whole", 4))).run()
    Trainer(parse(options(tmp_path / "broken", 2))).run()
    Trainer(parse(options(tmp_path / "broken", 4))).run()
    assert_same(tmp_path / "whole", tmp_path / "broken", 4)


def assert_same(whole: Path, other: Path, steps: int) -> None:
    """The states of two runs are equal to the bit, the seconds aside, and so are their exports."""
    one, two = (torch.load(folder / checkpoint.STATE, weights_only=True) for folder in (whole, other))
    assert one["steps"] == two["steps"] == steps
    assert (one["rows"], one["places"]) == (two["rows"], two["places"])
    for kind in ("master", "momentum"):
        for key, value in one["optimizer"][kind].items():
            assert torch.equal(value, two["optimizer"][kind][key]), key
    for slot, kept in one["optimizer"]["adam"]["state"].items():
        assert all(torch.equal(kept[k], two["optimizer"]["adam"]["state"][slot][k]) for k in kept)
    for file in (whole / "export").iterdir():
        assert file.read_bytes() == (other / "export" / file.name).read_bytes(), file.name


class Killed(BaseException):
    """Ends a run as a kill does: nothing is saved on the way out."""


def killed_after(monkeypatch: pytest.MonkeyPatch, told: list[str], step: int) -> None:
    """A run that is over right after the save of a step."""
    save = Trainer.save

    def last(trainer: Trainer) -> None:
        save(trainer)
        if trainer.steps == step:
            raise Killed

    with monkeypatch.context() as patched:
        patched.setattr(Trainer, "save", last)
        with pytest.raises(Killed):
            Trainer(parse(told)).run()


@pytest.mark.slow
def test_a_run_killed_after_any_step_ends_with_the_weights_of_an_undisturbed_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pools of few rows, so that kills fall within pools, at their ends, and where later ones are ordered already."""
    monkeypatch.setattr(row_stream, "POOL", 6)
    often = ["--save-every", "0"]
    Trainer(parse(options(tmp_path / "whole", 8))).run()
    for step in range(1, 8):
        told = [*options(tmp_path / f"killed-{step}", 8), *often]
        killed_after(monkeypatch, told, step)
        Trainer(parse(told)).run()
        assert_same(tmp_path / "whole", tmp_path / f"killed-{step}", 8)


@pytest.mark.slow
def test_a_run_killed_with_every_save_in_between_ends_alike(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(row_stream, "POOL", 6)
    Trainer(parse(options(tmp_path / "whole", 6))).run()
    told = [*options(tmp_path / "killed", 6), "--save-every", "0"]
    for step in range(1, 6):
        killed_after(monkeypatch, told, step)
    Trainer(parse(told)).run()
    assert_same(tmp_path / "whole", tmp_path / "killed", 6)


@pytest.mark.slow
def test_sigkill_of_two_ranks_between_two_saves_costs_nothing_but_time(tmp_path: Path) -> None:
    """Each of them stands elsewhere among its rows."""
    whole, killed = ([*options(tmp_path / name, 6), "--save-every", "0"] for name in ("whole", "killed"))
    for told in (whole, killed):
        told[told.index("--ranks") + 1] = "2"
        told[told.index("--workers") + 1] = "1"
    assert trained(whole).wait(900) == 0
    process = trained(killed)
    while steps_of(tmp_path / "killed") < 2 and process.poll() is None:
        time.sleep(0.1)
    process.kill()
    process.wait()
    assert 2 <= steps_of(tmp_path / "killed") < 6, "it was not killed on its way"
    assert trained(killed).wait(900) == 0
    assert_same(tmp_path / "whole", tmp_path / "killed", 6)


def trained(told: list[str]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "research.training.train", *told]
    return subprocess.Popen(command, cwd=settings.ROOT, stderr=subprocess.DEVNULL)


def steps_of(folder: Path) -> int:
    """Steps of the last save; 0 where there is none."""
    if not (folder / checkpoint.STATE).is_file():
        return 0
    return int(torch.load(folder / checkpoint.STATE, weights_only=True)["steps"])


@pytest.mark.slow
def test_a_step_draws_nothing_from_the_global_generators(tmp_path: Path) -> None:
    """No checkpoint keeps them."""
    trainer = Trainer(parse(options(tmp_path, 2)))
    before = torch.get_rng_state(), random.getstate(), np.random.get_state()[1].tolist()
    trainer.run()
    assert torch.equal(torch.get_rng_state(), before[0])
    assert (random.getstate(), np.random.get_state()[1].tolist()) == before[1:]


@pytest.mark.slow
def test_the_rows_are_the_same_whatever_the_number_of_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    folder, seen = str(settings.ROOT / "plugins" / "backbone" / "mini" / "weights"), []
    for workers in (0, 1):
        place, progress = Place(7), iter([0.0, 0.1, 0.2, 0.9, 0.9])
        made = Feed(folder, workers, place, stage="text")
        pools = made.pools(lambda progress=progress: next(progress))  # type: ignore[misc]
        seen.append([next(pools)])
        place.next(1)
        seen[-1].append(next(pools))
        made.close()
        assert place == Place(8, 0, [0.1, 0.2, 0.9])
    assert [(n, [row.ids for row in rows]) for n, rows in seen[0]] == [
        (n, [r.ids for r in rows]) for n, rows in seen[1]
    ]


def test_a_place_comes_back_from_its_numbers() -> None:
    for place in (Place(3), Place(40, 5, [0.0, 0.25, 1.0])):
        assert Place.of(place.numbers()) == place
        assert len(place.numbers()) == 2 + row_stream.AHEAD


def test_with_other_ranks_a_run_goes_on_behind_all_used_rows() -> None:
    places = [Place(10, 3, [0.5] * 3).numbers(), Place(15, 1, [0.5] * 3).numbers()]
    assert checkpoint.place_of(places, 1, 2) == Place(15, 1, [0.5] * 3)
    assert [checkpoint.place_of(places, rank, 3) for rank in range(3)] == [Place(16), Place(17), Place(18)]


def test_a_state_of_an_older_form_is_refused(tmp_path: Path) -> None:
    trainer = Trainer(parse(options(tmp_path, 1)))
    trainer.save()
    state = torch.load(tmp_path / "state.pt", weights_only=True)
    del state["places"]
    torch.save(state, tmp_path / "state.pt")
    with pytest.raises(ValueError, match=r"where each process stood among its rows: .* --start .*export"):
        Trainer(parse(options(tmp_path, 1)))


def test_a_half_written_tokenizer_is_made_again(tmp_path: Path) -> None:
    whole = checkpoint.make_tokenizer(parse(options(tmp_path / "whole", 1)))
    (half := tmp_path / "half" / "tokenizer").mkdir(parents=True)
    (half / "special_tokens_map.json").write_text("{")
    assert checkpoint.make_tokenizer(parse(options(tmp_path / "half", 1))).get_vocab() == whole.get_vocab()
