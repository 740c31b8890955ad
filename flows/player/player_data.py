"""The data of a case that the player and the picture show, as plain values; no HTML and no matplotlib."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from flows.player.player_highlights import facts_by_thing, road_along, road_axes, sentences_of
from flows.player.road_shapes import Drawing, drawing_of
from flows.player.sentence_marks import MARK_WORDS
from flows.player.signals_shown import SignalShown, signals_shown
from sgcad_core.case.records import ActorInfo, CrashReport, Floats, Scenario, Trajectory
from sgcad_core.case.traffic import Background
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Box, overlap_polygon
from sgcad_core.metrics.conflict import box_distance, time_to_collision
from sgcad_core.metrics.swept_cells import Track
from sgcad_core.reading.text.traced_text import redactions
from sgcad_core.result import CaseRecord

COLORS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b", "#7f7f7f")
"""Okabe and Ito's palette (told apart by color-blind readers); first red and blue, as crash diagrams draw V1 and V2."""
_LABELS = dict(
    zip(COLORS, ("#b34f00", "#0072b2", "#007a59", "#9c4a78", "#8f6200", "#1d6f9f", "#8c564b", "#666666"), strict=True)
)
TRAFFIC_COLOR = "#c9cfd4"
DIAGRAM_LIMIT = 3
"""Diagrams shown beside a player."""


def label_color(color: str) -> str:
    """The darker twin of an actor's color, on which white letters can be read (4.5 to 1, WCAG 2.1); else the color."""
    return _LABELS.get(color, color)


@dataclass(frozen=True)
class Mover:
    """One actor with its motion and color."""

    info: ActorInfo
    track: Trajectory
    color: str


@dataclass(frozen=True)
class View:
    """One executed case."""

    record: CaseRecord
    report: CrashReport
    metrics: Mapping[str, Any]
    result: Mapping[str, Any]
    drawing: Drawing
    movers: tuple[Mover, ...]
    runs: Mapping[str, Sequence[Trajectory]] = field(default_factory=dict)
    """Other runs of the same scenario, such as with drivers, by name."""
    name: str = "script"
    """Name of this run beside another one."""
    over: str = ""
    """Name of the run that is shown over this one at the start."""
    signals: Sequence[SignalShown] = ()
    drive: Mapping[str, Any] | None = None
    """Of a drive: its outcome with the reason, and the sentences of its rules."""
    traffic: Background = ()
    """Background vehicles, drawn lighter."""

    @staticmethod
    def of(
        record: CaseRecord,
        report: CrashReport,
        metrics: Mapping[str, Any],
        result: Mapping[str, Any],
        runs: Mapping[str, Sequence[Trajectory]] | None = None,
    ) -> View:
        """Collect a case's data. Raises InvalidOutput where the network cannot be read."""
        network, scenario, execution = record.network, record.scenario, record.execution
        if not (network and network.net_xml and scenario and execution):
            raise ValueError(f"case {record.case}: it was not executed, so there is nothing to show")
        infos = {actor.id: actor for actor in scenario.actors}
        movers = tuple(
            Mover(infos[track.actor], track, COLORS[k % len(COLORS)])
            for k, track in enumerate(execution.trajectories)
            if track.actor in infos
        )
        shown = signals_shown(parse_net(network.net_xml), scenario.xosc, movers[0].track.t_s if movers else np.zeros(0))
        return View(record, report, metrics, result, drawing_of(network.net_xml), movers, runs or {}, signals=shown)

    def among(self, traffic: Background) -> View:
        """The same with background vehicles."""
        return replace(self, traffic=traffic)

    def contact_point(self) -> tuple[float, float] | None:
        """Middle of the first overlap, metres; None if nothing touched."""
        contact = self.record.execution.contact if self.record.execution else None
        boxes = [self._box(actor, contact.t_s) for actor in (contact.actor, contact.other)] if contact else []
        if len(boxes) != 2 or boxes[0] is None or boxes[1] is None:
            return None
        middle = overlap_polygon(boxes[0], boxes[1]).mean(axis=0)
        return float(middle[0]), float(middle[1])

    def pair(self) -> tuple[Mover, Mover] | None:
        """The two actors of the contact, the near crash or the declared contact."""
        near = (self.result.get("near_crash") or {}).get("observed")
        collision = self.result["collision"]
        told = collision["observed"] or near or collision["declared"] or {}
        names = [told.get("actor") or told.get("striker"), told.get("other") or told.get("struck")]
        found = [mover for name in names for mover in self.movers if mover.info.id == name]
        return (found[0], found[1]) if len(found) == 2 else None

    def _nearness(self, run: Sequence[Trajectory] = ()) -> dict[str, Any] | None:
        """Distance of the pair's outlines, m, and time to collision at constant velocity, s, over time.

        `run`: of another run; None where one of the two has no motion there.
        """
        pair = self.pair()
        if pair is not None and run:
            tracks = {t.actor: t for t in run}
            found = [replace(m, track=tracks[m.info.id]) for m in pair if m.info.id in tracks]
            pair = (found[0], found[1]) if len(found) == 2 else None
        if pair is None:
            return None
        first, second = (_track(mover) for mover in pair)
        ttc = time_to_collision(first, second)
        return {
            "pair": [mover.info.id for mover in pair],
            "clearance_m": _rounded(box_distance(first, second), 2),
            "ttc_s": [round(v, 2) if math.isfinite(v) else None for v in ttc.tolist()],
        }

    def _box(self, actor: str, t_s: float) -> Box | None:
        mover = next((m for m in self.movers if m.info.id == actor), None)
        if mover is None:
            return None
        track = mover.track
        k = int(np.abs(track.t_s - t_s).argmin())
        pose = float(track.x_m[k]), float(track.y_m[k]), float(track.heading_rad[k])
        return Box(*pose, mover.info.length_m, mover.info.width_m)

    def _account(self) -> Sequence[Mapping[str, Any]]:
        """The items of the account."""
        items: Sequence[Mapping[str, Any]] = (self.result.get("account") or {}).get("items", ())
        return items

    def as_json(self) -> dict[str, Any]:
        """The data for the page's script, rounded to centimeters and milliradians."""
        contact = dict(self.result["collision"]["observed"] or {})
        if point := self.contact_point():
            contact |= {"x": round(point[0], 2), "y": round(point[1], 2)}
        return {
            "case": self.record.case,
            "config": self.record.config,
            "status": self.result["status"],
            "collision": {**self.result["collision"], "observed": contact or None},
            "near_crash": self.result.get("near_crash"),
            "account": self.result.get("account"),
            "disagreements": self.result.get("disagreements", []),
            "redactions": redactions(self.report.places),
            "network": self.result["network"],
            "place": (self.result.get("place") or {}).get("sentence", ""),
            "drawing": _drawing(self.drawing, road_axes(self.result.get("facts", ()))),
            "signals": {s.edge: s.changes for s in self.signals},
            "drive": self.drive,
            "actors": [_actor(mover) for mover in self.movers],
            "traffic": traffic_shown(self.traffic),
            "t_s": _rounded(self.movers[0].track.t_s, 2) if self.movers else [],
            "near": self._nearness(),
            "runs": [
                {"name": name, "actors": [_path(t) for t in tracks], "near": self._nearness(tracks)}
                for name, tracks in self.runs.items()
            ],
            "name": self.name,
            "over": self.over,
            "conditions": _conditions(self.record.scenario),
            "narrative": self.report.narrative,
            "sentences": sentences_of(self.report, self.result.get("facts", ()), self._account()),
            "marked": MARK_WORDS,
            "facts": facts_by_thing(self.result.get("facts", ())),
            "diagrams": [_data_url(d.png) for d in self.report.diagrams[:DIAGRAM_LIMIT]],
            "metrics": self.metrics,
            "grounding": self.result["grounding"],
            "attempts": self.result["attempts"],
            "seconds": self.result["seconds"],
        }


def _track(mover: Mover) -> Track:
    t = mover.track
    velocity = np.column_stack((t.speed_mps * np.cos(t.heading_rad), t.speed_mps * np.sin(t.heading_rad)))
    pose = t.pose
    return Track(t.t_s, pose, velocity, (mover.info.length_m, mover.info.width_m))


def _actor(mover: Mover) -> dict[str, Any]:
    return {
        **mover.info.model_dump(),
        "outline": mover.info.record.outline,
        "color": mover.color,
        "label": label_color(mover.color),
        **_path(mover.track),
    }


def traffic_shown(traffic: Background) -> list[dict[str, Any]]:
    """Background vehicles for the page's script."""
    return [
        {
            "id": info.id, "length_m": info.length_m, "width_m": info.width_m, "color": TRAFFIC_COLOR, **_path(track),
        }
        for info, track in traffic
    ]  # fmt: skip


def _path(track: Trajectory) -> dict[str, Any]:
    return {
        "id": track.actor,
        "x": _rounded(track.x_m, 2),
        "y": _rounded(track.y_m, 2),
        "heading": _rounded(track.heading_rad, 3),
        "speed": _rounded(track.speed_mps, 2),
        **({} if track.roll_rad is None else {"roll": _rounded(track.roll_rad, 2)}),
    }


def _drawing(drawing: Drawing, axes: Mapping[str, float]) -> dict[str, Any]:
    strips = ([round(s.width_m, 2), int(s.cars), _rounded(s.points.ravel(), 2), road_along(s, axes)]
              for s in drawing.strips)  # fmt: skip
    return {
        "areas": [_rounded(a.ravel(), 2) for a in drawing.areas],
        "strips": list(strips),
        "lines": [[line.style, _rounded(line.points.ravel(), 2)] for line in drawing.lines],
        "crossings": [[round(c.width_m, 2), _rounded(c.points.ravel(), 2)] for c in drawing.crossings],
        "cones": _rounded(drawing.cones.ravel(), 2),
        "grounds": [[kind, _rounded(area.ravel(), 2)] for kind, area in drawing.grounds],
        "gores": [_rounded(gore.ravel(), 2) for gore in drawing.gores],
        "marks": [
            [m.kind, round(m.x_m, 2), round(m.y_m, 2), round(m.heading_rad, 3), m.directions or m.edge]
            for m in drawing.marks
        ],
    }


def _conditions(scenario: Scenario | None) -> dict[str, str]:
    behavior = scenario.behavior if scenario else None
    found = {"light": behavior.light, "weather": behavior.weather, "surface": behavior.surface} if behavior else {}
    return {name: str(value) for name, value in found.items() if value}


def _rounded(values: Floats, digits: int) -> list[float]:
    return [round(v, digits) for v in values.tolist()]


def _data_url(png: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")
