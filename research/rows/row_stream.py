"""Training rows without end, made in worker processes: seed number n gives the same row everywhere.

The curriculum goes by stage (drawings, narratives, then everything; or mostly narratives; or gists beside those) and by
progress (0 to 1) of the budget: short texts first, longer ones later. A row's seed, mode and length follow from its
number and the progress at which its pool was ordered. A `Place` holds both, so that a resumed run sees the same rows.
"""

from __future__ import annotations

import multiprocessing as mp
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from queue import Empty
from random import Random
from typing import Any

from PIL import Image

from plugins.backbone.mini.drawing_view import VIEWS, quarters_of, turn_points, turn_upright
from research.generator.incidents import make_incident
from research.generator.report import TEXT_MODES, Report, make_report
from research.generator.writer_texts import shipped, some_report
from research.model.tokens import Coder, load_tokenizer
from research.renderer.draw import Shape, draw_labeled
from research.rows.gist_rows import gist_row, told_of
from research.rows.partial_labels import Told, load
from research.rows.report_rows import MAX_TEXT, training_row
from research.rows.row import Row
from sgcad_core.system.parent_end import end_with_parent

POOL = 96
MOVED = 0.5
"""Share of the drawings that do not fill their sheet."""
WORN = (0.12, 0.06)
"""Shares of the tokens that are broken up and of the words to spare that are left out, in every second narrative."""
AHEAD = 3
HELD_OUT_BASE = 50_000_000
"""Seeds from here on are for measuring."""


MIXED = {"text": 35.0, "image": 28.0, "both": 24.0, "none": 7.0, "thin": 2.5, "no_crash": 2.0, "conflict": 1.5}
"""More rows of one source than are measured (`MODES`): where both tell a value, there is least left to learn."""
WORDS = {"text": 66.0, "both": 14.0, "image": 8.0, "none": 5.0, "thin": 3.0, "no_crash": 2.0, "conflict": 2.0}
"""Mostly narratives, with so many drawings that these are not unlearned."""
DRAWN = {"image": 52.0, "both": 20.0, "text": 14.0, "none": 7.0, "thin": 3.0, "no_crash": 2.0, "conflict": 2.0}
"""Mostly drawings."""
STAGES: dict[str, dict[str, float]] = {
    "text": TEXT_MODES,
    "pictures": {"image": 1.0},
    "words": WORDS,
    "all": MIXED,
    "gist": WORDS,
    "written": MIXED,
    "drawings": DRAWN,
}
"""Weights of the modes that a stage of training shows."""
GISTS = {"told": 0.52, "incident": 0.2, "made": 0.16}
"""Shares of the rows of the stage "gist" that ask the gist alone: of told texts, made incidents and made narratives."""

WRITTEN = {"written": 0.5, "drawings": 0.12}
"""Shares of the rows of a stage that are narratives of writers; the others are made ones."""
RARE = 0.6
"""Share of the drawings of the stage "drawings" that are chosen to show what few do: turn lanes, center turn lanes, or
an actor of a kind that is seldom seen."""
RARE_TRIES = 30
RARE_STEP = 1_000_000_000
"""Seeds from one try to the next, above all that are counted through."""

PARTS = (("pictures", 0.15), ("text", 0.15), ("all", 0.7))
"""Shares of the budget of a run that goes through the stages by itself."""


def stage_at(stage: str, progress: float) -> tuple[str, float]:
    """The stage at a progress (0 to 1) of a run and the progress within it; "auto" goes through all of them."""
    if stage != "auto":
        return stage, progress
    begun = 0.0
    for name, share in PARTS[:-1]:
        if progress < begun + share:
            return name, (progress - begun) / share
        begun += share
    return PARTS[-1][0], min(1.0, (progress - begun) / PARTS[-1][1])


def length_for(rng: Random, stage: str, progress: float) -> float:
    """How much noise a report gets: little at first, later up to as much as real ones have."""
    if stage == "text":
        return rng.random() * (0.1 + 0.5 * progress)
    return float(rng.random() ** (1.6 - 0.6 * progress)) * (0.5 + 0.9 * progress)


def one_row(coder: Coder, seed: int, progress: float, stage: str = "all", told: Sequence[Told] = ()) -> Row:
    """The row of a seed; reports that are too long are told again with less noise."""
    if stage == "gist" and (text := _gist(Random(f"{seed} gist"), seed, told)):
        rng = Random(f"{seed} worn")
        return gist_row(coder, text, rng, WORN if rng.random() < 0.5 else (0.0, 0.0))
    rng = Random(seed)
    report = _report(rng, seed, progress, stage)
    view = rng.randrange(len(VIEWS)) if rng.random() < MOVED else 0
    worn = WORN if rng.random() < 0.5 else (0.0, 0.0)
    return training_row(coder, report, *labeled(report), view, worn)


def _report(rng: Random, seed: int, progress: float, stage: str) -> Report:
    """The report of a seed: a writer's, or a made one that is not too long."""
    length = length_for(rng, stage, progress)
    if Random(f"{seed} writer").random() < WRITTEN.get(stage, 0.0):
        return some_report(shipped(), seed)
    if stage == "drawings" and Random(f"{seed} rare").random() < RARE:
        seed = _rare(seed)
    while True:
        report = make_report(seed, False, length, STAGES[stage])
        if len(report.narrative) < MAX_TEXT * 4.6 or length < 0.05:
            return report
        length *= 0.7


def _rare(seed: int) -> int:
    """A seed, made from this one, whose report is of the same mode and whose drawing shows something rare; the seed
    itself where it has no drawing or none that is tried shows that."""
    own = make_report(seed, False, 0.0, DRAWN)
    if not own.has_image or shows_rare(own):
        return seed
    others = range(seed + RARE_STEP, seed + RARE_TRIES * RARE_STEP, RARE_STEP)
    reports = ((other, make_report(other, False, 0.0, DRAWN)) for other in others)
    return next((other for other, report in reports if report.mode == own.mode and shows_rare(report)), seed)


def shows_rare(report: Report) -> bool:
    """Whether a report's drawing shows turn lanes, center turn lanes, or a kind of actor that is seldom seen."""
    crash = report.shown or report.crash
    arrows = any(leg.turns_in and f"turns.{leg.bearing % 4}" in report.drawn for leg in crash.legs)
    seldom = any(actor.vehicle and f"kind.{actor.id}" in report.drawn for actor in crash.actors)
    return arrows or seldom or any(leg.twltl for leg in crash.legs)


def _gist(rng: Random, seed: int, told: Sequence[Told]) -> Told | None:
    """The text whose gist a seed asks for; None: it asks for a whole report, as without told texts a share does."""
    share = rng.random()
    if told and share < GISTS["told"]:
        return rng.choice(told)
    if share < GISTS["told"] + GISTS["incident"]:
        return make_incident(seed)
    if share < sum(GISTS.values()):
        return told_of(make_report(seed, False, rng.random(), {"text": 1.0}))
    return None


def labeled(report: Report) -> tuple[Image.Image | None, list[Shape]]:
    """The report's diagram, turned so that north is up, and its shapes; None where it has none."""
    if not report.has_image:
        return None, []
    drawn = draw_labeled(report)
    quarters = quarters_of(drawn.turn)
    size = drawn.image.size
    shapes = [Shape(turn_points(s.corners, size, quarters), s.tags, s.least) for s in drawn.shapes]
    return turn_upright(drawn.image, quarters), shapes


def drawing(report: Report) -> Image.Image | None:
    """The report's diagram as it was drawn, or None."""
    return draw_labeled(report).image if report.has_image else None


def pool(coder: Coder, number: int, progress: float, stage: str = "all", told: Sequence[Told] = ()) -> list[Row]:
    """POOL rows, sorted by length."""
    stage, within = stage_at(stage, progress)
    rows = [one_row(coder, number * POOL + i, within, stage, told) for i in range(POOL)]
    return sorted(rows, key=lambda row: len(row.ids))


def _work(folder: str, stage: str, told: str, jobs: Any, done: Any) -> None:
    end_with_parent()
    import torch

    torch.set_num_threads(1)
    make = _maker(folder, stage, told)
    while (job := jobs.get()) is not None:
        number, progress = job
        done.put((number, make(number, progress)))
    done.cancel_join_thread()


def _maker(folder: str, stage: str, told: str) -> Callable[[int, float], list[Row]]:
    """`pool` of a folder's tokenizer, a stage and a file of told texts, if there is one."""
    texts = load(Path(told)) if told else []
    return partial(pool, Coder(load_tokenizer(Path(folder))), stage=stage, told=texts)


@dataclass
class Place:
    """Where a training stands among its rows: so many batches of a pool were used, and at which progress that pool and
    those behind it were ordered, at most AHEAD of them."""

    pool: int
    used: int = 0
    ordered: list[float] = field(default_factory=list)

    @property
    def made_at(self) -> float:
        """Progress at which the pool in use was ordered; 0 before there is one."""
        return self.ordered[0] if self.ordered else 0.0

    def next(self, stride: int) -> None:
        """On to the next pool of this process."""
        self.pool, self.used = self.pool + stride, 0
        del self.ordered[:1]

    def numbers(self) -> list[float]:
        """The same as numbers, always as many; -1 stands for a pool that is not ordered yet."""
        return [self.pool, self.used, *self.ordered, *[-1.0] * (AHEAD - len(self.ordered))]

    @classmethod
    def of(cls, numbers: Sequence[float]) -> Place:
        """The place that `numbers` told."""
        return cls(int(numbers[0]), int(numbers[1]), [at for at in numbers[2:] if at >= 0])


class Feed:
    """Pools in order, a few ahead; the same rows whatever the number of workers (0: made in this process)."""

    def __init__(
        self, folder: str, workers: int, place: Place, stride: int = 1, stage: str = "all", told: str = ""
    ) -> None:
        """`place` is the trainer's, which moves it on; pools are `stride` apart."""
        context = mp.get_context("spawn")
        self.jobs: Any = context.Queue()
        self.done: Any = context.Queue()
        self.place, self.asked, self.stride = place, 0, stride
        self.ready: dict[int, list[Row]] = {}
        self.workers = [
            context.Process(target=_work, args=(folder, stage, told, self.jobs, self.done), daemon=True)
            for _ in range(workers)
        ]
        self.make = None if workers else _maker(folder, stage, told)
        for worker in self.workers:
            worker.start()

    def pools(self, progress: Callable[[], float]) -> Iterator[tuple[int, list[Row]]]:
        """(number, rows) of the place's pool, which has moved on whenever the next is asked for; without end.

        progress() is asked when a pool is ordered, unless the place says it already.
        """
        begun = self.place.pool
        while True:
            self._order(progress, begun)
            number = self.place.pool
            yield number, self._fetched(number) if self.make is None else self.make(number, self.place.made_at)

    def _order(self, progress: Callable[[], float], begun: int) -> None:
        """Order the place's pool and those ahead of it, as far as they are not."""
        place = self.place
        while len(place.ordered) < AHEAD:
            place.ordered.append(round(progress(), 3))
        for ahead, at in enumerate(place.ordered):
            number = place.pool + ahead * self.stride
            if self.make is None and number >= begun + self.asked * self.stride:
                self.jobs.put((number, at))
                self.asked += 1

    def _fetched(self, wanted: int) -> list[Row]:
        """A pool that the workers were asked for."""
        while wanted not in self.ready:
            number, rows = self._made()
            self.ready[number] = rows
        return self.ready.pop(wanted)

    def _made(self) -> tuple[int, list[Row]]:
        """What a worker made. Raises RuntimeError as soon as one has died: its pool would never come."""
        while True:
            try:
                return self.done.get(timeout=5)  # type: ignore[no-any-return]
            except Empty:
                ended = [worker.exitcode for worker in self.workers if not worker.is_alive()]
                if ended:
                    raise RuntimeError(
                        f"a process that makes training rows has ended (exit code {ended[0]}), its error stands above; "
                        "call again to go on from the last checkpoint"
                    ) from None

    def close(self) -> None:
        """Stop the workers."""
        for _ in self.workers:
            self.jobs.put(None)
        for worker in self.workers:
            worker.join(timeout=2)
            if worker.is_alive():
                worker.kill()
