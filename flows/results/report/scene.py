"""One executed case to be drawn from its folder: the road, all paths, the first contact. Knows no pixels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flows.player.player_data import COLORS
from flows.player.road_shapes import Drawing, drawing_of
from flows.results.reading import FinishedCase, paths_of
from sgcad_core.case.records import Floats
from sgcad_core.errors import InvalidOutput
from sgcad_core.geometry.plane import Box, overlap_polygon
from sgcad_core.metrics.labels.motion_label_match import Path

MARGIN_M, LEAST_M, MOST_M = 14.0, 25.0, 60.0


@dataclass(frozen=True)
class Scene:
    """A case's road and motion; `contact_s` is None where nothing touched."""

    drawing: Drawing
    paths: Mapping[str, Path]
    contact_s: float | None
    contact_at: tuple[float, float]

    def color(self, path: Path) -> str:
        """An actor's color, the player's."""
        return COLORS[next(k for k, p in enumerate(self.paths.values()) if p is path) % len(COLORS)]

    @staticmethod
    def box(path: Path, t_s: float) -> Box:
        """Box of an actor at the step nearest to a time."""
        x, y, heading = (float(v) for v in path.pose[int(np.abs(path.t_s - t_s).argmin())])
        return Box(x, y, heading, *path.size)

    @property
    def middle(self) -> tuple[float, float]:
        """Middle of the picture: the contact, else the middle of all paths; meters."""
        if self.contact_s is not None:
            return self.contact_at
        low, high = self._bounds()
        return float((low[0] + high[0]) / 2), float((low[1] + high[1]) / 2)

    @property
    def half_m(self) -> float:
        """Half the side of the square to look at: it holds all paths, but no more than can be made out."""
        low, high = self._bounds()
        return float(min(max((high - low).max() / 2 + MARGIN_M, LEAST_M), MOST_M))

    def _bounds(self) -> tuple[Floats, Floats]:
        points = np.vstack([p.pose[:, :2] for p in self.paths.values()]) if self.paths else np.zeros((1, 2))
        return points.min(axis=0), points.max(axis=0)


def scene_of(ran: FinishedCase) -> Scene | None:
    """The scene of an executed case; None where there is no readable network or motion."""
    try:
        drawing = drawing_of((ran.folder / "road.net.xml").read_text(encoding="utf-8"))
        paths = paths_of(ran.folder, ran.result)
    except (OSError, ValueError, InvalidOutput):
        return None
    if not paths:
        return None
    observed = (ran.result.get("collision") or {}).get("observed")
    if not observed or not {observed["actor"], observed["other"]} <= set(paths):
        return Scene(drawing, paths, None, (0.0, 0.0))
    boxes = [Scene.box(paths[observed[who]], observed["t_s"]) for who in ("actor", "other")]
    x, y = overlap_polygon(boxes[0], boxes[1]).mean(axis=0)
    return Scene(drawing, paths, float(observed["t_s"]), (float(x), float(y)))
