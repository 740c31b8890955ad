"""Crashes with closed answers: two cars on an empty plane, straight and at constant speeds until they touch."""

from __future__ import annotations

import math

import numpy as np

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.handover.script import Script
from sgcad_core.records.specs import Contact
from sgcad_core.roads.lane_graph import LaneGraph

EMPTY = LaneGraph({}, (), {})
LENGTH, WIDTH = 4.7, 1.8
STEP = 0.05


def track(actor, x, y, heading, speed, contact_s, after_s=3.0):
    """A car that passes (x, y) at the contact and stands from then on."""
    t = np.round(np.arange(round((contact_s + after_s) / STEP) + 1) * STEP, 3)
    gone = np.minimum(t - contact_s, 0.0) * speed
    n = len(t)
    return Trajectory(
        actor=actor, t_s=t, x_m=x + gone * math.cos(heading), y_m=y + gone * math.sin(heading),
        heading_rad=np.full(n, heading), speed_mps=np.where(t < contact_s, speed, 0.0),
    )  # fmt: skip


def info(actor, kind="car", length=LENGTH, width=WIDTH, maneuver="straight"):
    return ActorInfo(id=actor, type=kind, length_m=length, width_m=width, maneuver=maneuver)


def script(tracks, declared, roles=None, kinds=None, surface="dry"):
    infos = tuple(info(t.actor, (kinds or {}).get(t.actor, "car")) for t in tracks)
    return Script("made", infos, tuple(tracks), EMPTY, declared, roles or {}, surface)


def crossing(own=10.0, other=10.0, contact_s=6.0, surface="dry"):
    """V1, eastbound, strikes with its front the left side of V2, northbound."""
    reach = -(WIDTH + LENGTH) / 2 + 0.02
    return script(
        [track("V1", reach, 0.0, 0.0, own, contact_s), track("V2", 0.0, 0.0, math.pi / 2, other, contact_s)],
        Contact(striker="V1", struck="V2", striker_area="front", struck_area="left"),
        {"V1": "responder", "V2": "initiator"},
        surface=surface,
    )


def rear_end(own=20.0, other=0.0, contact_s=6.0, kinds=None):
    """V1 runs into the rear of V2, both eastbound; V2 may stand."""
    return script(
        [track("V1", -LENGTH + 0.02, 0.0, 0.0, own, contact_s), track("V2", 0.0, 0.0, 0.0, other, contact_s)],
        Contact(striker="V1", struck="V2", striker_area="front", struck_area="back"),
        {"V1": "initiator", "V2": "responder"},
        kinds,
    )


def turned(made, angle, dx=0.0, dy=0.0):
    """The same script turned about the origin and moved."""
    c, s = math.cos(angle), math.sin(angle)
    tracks = tuple(
        t.model_copy(
            update={"x_m": t.x_m * c - t.y_m * s + dx, "y_m": t.x_m * s + t.y_m * c + dy,
                    "heading_rad": t.heading_rad + angle}
        )
        for t in made.trajectories
    )  # fmt: skip
    return Script(made.case, made.actors, tracks, made.graph, made.declared, made.roles, made.surface)
