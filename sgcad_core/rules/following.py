"""Following distance: headway from front to front behind a vehicle in the same lane (UVC 11-310 (a): not more closely
than is reasonable and prudent). Measured: the least headway, s.

Only steady following counts (`RuleLimits.headway_lasts_s`): closing in on a vehicle that stands is no following. Across
junctions no vehicle counts as followed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sgcad_core.geometry.plane import Floats, runs
from sgcad_core.metrics.lane_places import PLACES
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, Status, lasts_s

_NEAR_S = 3.0
"""A vehicle further ahead is not followed."""

_ALIKE = 0.7
"""Cosine of the angle between headings of vehicles that go the same way."""


def following_distance(scene: RuleScene) -> Iterator[RuleFinding]:
    """For each vehicle and each one that it follows: the worst stretch, or the least headway."""
    for mover in scene.movers:
        for leader in scene.movers:
            if leader is not mover and mover.lanes_bound and leader.info.record.wheeled:
                yield from _pair(scene, mover, leader)


def _pair(scene: RuleScene, mover: Mover, leader: Mover) -> Iterator[RuleFinding]:
    told, headway = scene.limits, _headway(scene, mover, leader)
    if not (headway < _NEAR_S).any():
        return
    short = [r for r in runs(headway < told.headway_s) if lasts_s(r) >= told.headway_lasts_s]
    span = max(short, key=lambda r: r[1] - r[0], default=None)
    status: Status = "broken" if span else "kept"
    if span is None:
        at = int(headway.argmin())
        span = at, at
    least = float(headway[span[0] : span[1] + 1].min())
    where, limit = mover.steps.lanes[span[0]], told.headway_s
    yield mover.found("following_distance", status, span, where, least, limit, "s of headway", other=leader.id)


def _headway(scene: RuleScene, mover: Mover, leader: Mover) -> Floats:
    """(n,) seconds; inf where the other is not followed."""
    n = min(len(mover.pose), len(leader.pose))
    a, b = mover.pose[:n], leader.pose[:n]
    ahead = np.cos(a[:, 2]) * (b[:, 0] - a[:, 0]) + np.sin(a[:, 2]) * (b[:, 1] - a[:, 1])
    apart = ahead + leader.info.length_m / 2 - mover.info.length_m / 2
    same = np.array([one == two != "" for one, two in zip(mover.steps.lanes[:n], leader.steps.lanes[:n], strict=True)])
    same &= np.cos(a[:, 2] - b[:, 2]) > _ALIKE
    same &= np.isin(mover.steps.codes[:n], [PLACES.index("lane"), PLACES.index("beyond")])
    slow = np.minimum(mover.speed_mps[:n], leader.speed_mps[:n]) < scene.limits.headway_from_mps
    follows = same & (ahead > 0) & ~slow
    return np.where(follows, apart / np.maximum(mover.speed_mps[:n], 0.1), np.inf)
