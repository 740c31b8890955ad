"""crash.mp4 and crash.gif of a finished case: plan view, report, speeds, the verdict. 20 steps a second, real time.

The road is drawn once by the picture's own code, the rest frame by frame. The mp4 needs the extra `video`, which brings
ffmpeg; a gif needs nothing more.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flows.export.finished_case import FinishedCase
from flows.player import overview_png
from flows.player.player_data import COLORS, TRAFFIC_COLOR
from flows.player.road_shapes import drawing_of
from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.errors import MissingTool
from sgcad_core.geometry.plane import Box, corners
from sgcad_core.system import temp_folders
from sgcad_core.system.pictures import opened
from sgcad_core.units import MPS_PER_MPH

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFont

KINDS = ("mp4", "gif")
SIDE, PANEL = 640, 480
"""Pixels: the square plan view, and the width of the column beside it."""
STEP_S = 0.05
GIF_FPS, GIF_SCALE = 10, 0.5
HOLD_S = 1.0
"""The last picture stays so long."""
MARGIN_M, LEAST_M, MOST_M = 12.0, 25.0, 55.0
INK, PALE, PAPER = "#1d2125", "#5b6067", "#ffffff"
_VERDICT = {"whole": "#1b7f4b", "lacking": "#b3261e", "contradicts": "#b3261e"}
_DOUBT = "#9a6700"
_FREE_PX = 60
"""So far from other vehicles a name is out of their way."""
_REPORT_LINES, _REPORT_CHARS = 17, 62
_SPEEDS_TOP, _SPEEDS = 50 + 19 * _REPORT_LINES + 14, 5
"""Pixels from the top to the speeds, and of how many actors they are told."""


def film(folder: Path, out: Path, kinds: Sequence[str], fps: int) -> Iterator[Path]:
    """Write a case's films into a folder, each whole or not at all; paths as they are ready.

    Raises BadInput, MissingTool.
    """
    scene = Shots(FinishedCase(folder))
    if "mp4" in kinds:
        check_ffmpeg()
    out.mkdir(parents=True, exist_ok=True)
    with temp_folders.folder_beside(out / "crash") as partial:  # a film takes a while, and a cut one plays too
        for kind in (kind for kind in KINDS if kind in kinds):
            file = partial / f"crash.{kind}"
            if kind == "mp4":
                _mp4(scene, file, fps)
            else:
                _gif(scene, file)
            yield file.replace(out / file.name)


def check_ffmpeg() -> Any:
    """The module that brings ffmpeg. Raises MissingTool."""
    try:
        import imageio_ffmpeg
    except ImportError as fault:
        raise MissingTool(
            "mp4: ffmpeg is not installed; pip install 'sg-cadvlm[video]', or ask for a gif alone (--format gif)"
        ) from fault
    return imageio_ffmpeg


def _mp4(scene: Shots, file: Path, fps: int) -> None:
    writer = check_ffmpeg().write_frames(str(file), (SIDE + PANEL, SIDE), fps=fps, macro_block_size=2)
    writer.send(None)
    try:
        for picture in scene.frames(fps):
            writer.send(picture.tobytes())
    finally:
        writer.close()


def _gif(scene: Shots, file: Path) -> None:
    size = round((SIDE + PANEL) * GIF_SCALE), round(SIDE * GIF_SCALE)
    shots = [picture.resize(size).quantize(128) for picture in scene.frames(GIF_FPS)]
    shots[0].save(file, save_all=True, append_images=shots[1:], duration=round(1000 / GIF_FPS), loop=0, optimize=True)


@dataclass(frozen=True)
class Shots:
    """A case's pictures over time."""

    case: FinishedCase

    def frames(self, fps: int) -> Iterator[Image.Image]:
        """RGB pictures at a rate, the last one held."""
        tracks = self.case.script.trajectories
        end = float(tracks[0].t_s[-1])
        for k in range(int(end * fps) + 1):
            yield (last := self._picture(k / fps))
        yield from [last] * round(HOLD_S * fps)

    @cached_property
    def _frame(self) -> tuple[tuple[float, float], float]:
        """Middle and half the side of the square: around the contact, else around all paths, metres."""
        points = np.vstack([t.points for t in self.case.script.trajectories])
        low, high = points.min(axis=0), points.max(axis=0)
        half = float(min(max((high - low).max() / 2 + MARGIN_M, LEAST_M), MOST_M))
        middle = (low + high) / 2 if self._contact is None or half < MOST_M else np.array(self._contact_place())
        return (float(middle[0]), float(middle[1])), half

    @property
    def _contact(self) -> dict[str, Any] | None:
        return (self.case.result.get("collision") or {}).get("observed")

    def _contact_place(self) -> tuple[float, float]:
        told = self._contact or {}
        pair = [t for t in self.case.script.trajectories if t.actor in (told["actor"], told["other"])]
        at = np.mean([t.points[min(round(told["t_s"] / STEP_S), len(t.t_s) - 1)] for t in pair], axis=0)
        return float(at[0]), float(at[1])

    @cached_property
    def _ground(self) -> Image.Image:
        """Road and report: what does not move."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
        from PIL import Image, ImageDraw

        (x, y), half = self._frame
        inches = SIDE / 100
        figure = Figure(figsize=(inches, inches), dpi=100, facecolor=overview_png.GROUND)
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
        overview_png.draw_network(axes, drawing_of(self.case.script.net_xml), inches * 72 / (2 * half))
        out = io.BytesIO()
        figure.savefig(out, format="png")
        whole = Image.new("RGB", (SIDE + PANEL, SIDE), PAPER)
        whole.paste(opened(out.getvalue()).convert("RGB"), (0, 0))
        self._write_report(ImageDraw.Draw(whole))
        return whole

    def _write_report(self, pen: ImageDraw.ImageDraw) -> None:
        left = SIDE + 20
        pen.text((left, 16), self.case.script.case[:44], INK, _font(18, bold=True))
        file = self.case.folder / "report.txt"
        told = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
        lines = textwrap.wrap(" ".join(told.split()), _REPORT_CHARS)
        if len(lines) > _REPORT_LINES:
            lines = [*lines[: _REPORT_LINES - 1], lines[_REPORT_LINES - 1][: _REPORT_CHARS - 4] + " ..."]
        for k, line in enumerate(lines):
            pen.text((left, 50 + 19 * k), line, INK, _font(13))
        self._write_verdict(pen, left)

    @property
    def verdict_lines(self) -> list[str]:
        """The verdict as far as there is room for it below the speeds."""
        room = SIDE - 28 - (_SPEEDS_TOP + 28 + 20 * len(self.case.script.trajectories[:_SPEEDS]))
        said = verdict_sentence(self.case.result)
        return textwrap.wrap(said, _REPORT_CHARS, max_lines=room // 19, placeholder=" ...")

    def _write_verdict(self, pen: ImageDraw.ImageDraw, left: int) -> None:
        account = self.case.result.get("account") or {}
        color = _VERDICT.get(account.get("verdict", ""), _DOUBT)
        lines = self.verdict_lines
        top = SIDE - 20 - 19 * len(lines)
        pen.rectangle((left - 10, top - 2, left - 6, SIDE - 20), fill=color)
        for k, line in enumerate(lines):
            pen.text((left, top + 19 * k), line, color, _font(13))

    def _picture(self, t_s: float) -> Image.Image:
        from PIL import ImageDraw

        picture = self._ground.copy()
        pen = ImageDraw.Draw(picture)
        script = self.case.script
        for info, track in self.case.background:
            self._draw_background(pen, info, track, t_s)
        for k, track in enumerate(script.trajectories):
            self._draw_actor(pen, script.info(track.actor), track, COLORS[k % len(COLORS)], t_s)
        self._write_names(pen, t_s)
        beside = (SIDE, 0, SIDE + PANEL, SIDE)
        picture.paste(self._ground.crop(beside), beside)  # over what lies beside the plan view
        self._write_speeds(pen, t_s)
        return picture

    def _draw_background(self, pen: ImageDraw.ImageDraw, info: ActorInfo, track: Trajectory, t_s: float) -> None:
        """A vehicle of the traffic: without trail and name."""
        x, y, heading = (float(v) for v in track.pose[min(round(t_s / STEP_S), len(track.t_s) - 1)])
        box = corners(Box(x, y, heading, info.length_m, info.width_m))
        pen.polygon([self._pixel(*point) for point in box], fill=TRAFFIC_COLOR, outline=PAPER)

    def _draw_actor(self, pen: ImageDraw.ImageDraw, info: ActorInfo, track: Trajectory, color: str, t_s: float) -> None:
        row = min(round(t_s / STEP_S), len(track.t_s) - 1)
        trail = [self._pixel(x, y) for x, y in track.points[: row + 1 : 4]]
        if len(trail) > 1:
            pen.line(trail, fill=color, width=2)
        x, y, heading = (float(v) for v in track.pose[row])
        box = corners(Box(x, y, heading, info.length_m, info.width_m))
        pen.polygon([self._pixel(*point) for point in box], fill=color, outline=PAPER)
        pen.line([self._pixel(*box[0]), self._pixel(*box[3])], fill=INK, width=2)  # its front

    def _write_names(self, pen: ImageDraw.ImageDraw, t_s: float) -> None:
        for name, at in self.name_places(t_s).items():
            pen.text(at, name, INK, _font(13, bold=True), anchor="mm", stroke_width=2, stroke_fill=PAPER)

    def name_places(self, t_s: float) -> dict[str, tuple[float, float]]:
        """Pixels of each actor's name: on the side of its box that is farthest from the other actors."""
        tracks, scale = self.case.script.trajectories, SIDE / (4 * self._frame[1])  # pixels of half a metre
        poses = [track.pose[min(round(t_s / STEP_S), len(track.t_s) - 1)] for track in tracks]
        middles = [np.array(self._pixel(x, y)) for x, y, _ in poses]
        found = {}
        for k, track in enumerate(tracks):
            info, others = self.case.script.info(track.actor), [at for i, at in enumerate(middles) if i != k]
            places = []
            for quarter, reach_m in enumerate((info.width_m, info.length_m) * 2, start=1):
                turn, away = float(poses[k][2]) + quarter * math.pi / 2, 14 + round(reach_m * scale)
                places.append(middles[k] + away * np.array((math.cos(turn), -math.sin(turn))))
            free = [min((float(np.hypot(*(at - one))) for one in others), default=math.inf) for at in places]
            best = next(at for at, room in zip(places, free, strict=True) if room >= min(max(free), _FREE_PX))
            found[info.id] = float(best[0]), float(best[1])
        return found

    def _write_speeds(self, pen: ImageDraw.ImageDraw, t_s: float) -> None:
        left, top = SIDE + 20, _SPEEDS_TOP
        pen.text((left, top), f"{t_s:5.2f} s", INK, _font(15, bold=True))
        if (told := self._contact) and t_s >= told["t_s"]:
            said = f"{told['actor']} {told['actor_area']} meets {told['other']} {told['other_area']}"
            pen.text((left + 90, top), said, overview_png.RED, _font(15, bold=True))
        for k, track in enumerate(self.case.script.trajectories[:_SPEEDS]):
            row = min(round(t_s / STEP_S), len(track.t_s) - 1)
            speed = float(track.speed_mps[row])
            y = top + 28 + 20 * k
            pen.rectangle((left, y + 2, left + 12, y + 14), fill=COLORS[k % len(COLORS)])
            kind = self.case.script.info(track.actor).type.replace("_", " ")
            pen.text((left + 20, y), f"{track.actor} {kind}"[:26], INK, _font(13))
            told_speed = f"{speed * 3.6:4.0f} km/h  {speed / MPS_PER_MPH:4.0f} mph"
            pen.text((left + 250, y), told_speed, INK, _font(13))

    def _pixel(self, x_m: float, y_m: float) -> tuple[float, float]:
        (x, y), half = self._frame
        scale = SIDE / (2 * half)
        return (float(x_m) - x + half) * scale, SIDE - (float(y_m) - y + half) * scale


def _font(size: int, *, bold: bool = False) -> ImageFont.FreeTypeFont:
    """The font that comes with matplotlib."""
    import matplotlib
    from PIL import ImageFont

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name), size)
