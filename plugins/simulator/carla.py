"""CARLA through its client package: reads the map offline; replays the player's trajectories on a user's server.

The map is parsed by the client's own class, without a server: a second OpenDRIVE reader. The replay needs a running
server and HAS NEVER BEEN RUN by this project (no server was at hand); it is kept thin for those who have one. CARLA's
axes are x east, y SOUTH, yaw clockwise in degrees; an actor's location is the middle of its box on the ground.
"""

from __future__ import annotations

import importlib
import math
from typing import Any

import numpy as np
from pydantic import Field

from sgcad_core.case.records import ActorInfo, Execution, Floats, RoadNetwork, Scenario, Trajectory
from sgcad_core.errors import MissingTool, SimulationFailed
from sgcad_core.execution.playback import execution_of, played
from sgcad_core.formats.openscenario.playing.player import DT_S
from sgcad_core.interfaces import Simulator

APART_M = 2.0
"""Between the waypoints that a map is sampled at."""


class Carla(Simulator):
    """Reads the .xodr with CARLA's client; with `host` set, also replays on that server (never tried).

    port is the server's, timeout_s the longest wait for an answer, seconds.
    """

    host: str = ""
    """A running server; empty: the map is read, and the trajectories are those of the project's player."""
    port: int = Field(2000, ge=1, le=65535)
    timeout_s: float = Field(30.0, gt=0, le=600)

    def ready(self) -> None:
        """Raises MissingTool without the client package."""
        client()

    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Reads the map, plays the .xosc and, with a server, replays it. Raises MissingTool, SimulationFailed."""
        if not network.xodr:
            raise SimulationFailed("CARLA needs an .xodr: compile the road network first")
        told = f"CARLA's client reads {waypoints(network.xodr)} waypoints"
        motions = played(scenario, network)
        seen = _replay(self, scenario, network.xodr, motions) if self.host else motions
        return execution_of("carla", scenario, seen, told if self.host else f"{told}; no host: not replayed there")


def client() -> Any:
    """CARLA's client package. Raises MissingTool."""
    try:
        return importlib.import_module("carla")
    except ImportError as fault:
        raise MissingTool("CARLA's client is not installed: `pip install sg-cadvlm[carla]`") from fault


def waypoints(xodr: str) -> int:
    """Number of waypoints, 2 m apart, that the client's map class finds. Raises MissingTool, SimulationFailed."""
    carla = client()
    try:
        found = carla.Map("road", xodr).generate_waypoints(APART_M)
    except RuntimeError as fault:
        raise SimulationFailed(f"CARLA's client cannot read the .xodr: {fault}") from fault
    if not found:
        raise SimulationFailed("CARLA's client finds no lane to drive on in the .xodr")
    return len(found)


# ------------------------------------------------------------------ replay: never run here
def _replay(
    fields: Carla, scenario: Scenario, xodr: str, motions: tuple[Trajectory, ...]
) -> list[Trajectory]:  # pragma: no cover - needs a server
    carla = client()
    try:
        server = carla.Client(fields.host, fields.port)
        server.set_timeout(fields.timeout_s)
        world = server.generate_opendrive_world(xodr)
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, DT_S
        world.apply_settings(settings)
        bodies = [_spawn(carla, world, actor, t) for actor, t in zip(scenario.actors, motions, strict=True)]
        return _driven(carla, world, bodies, motions)
    except RuntimeError as fault:
        raise SimulationFailed(f"CARLA at {fields.host}:{fields.port}: {fault}") from fault


def _spawn(carla: Any, world: Any, actor: ActorInfo, t: Trajectory) -> Any:  # pragma: no cover - needs a server
    blueprint = world.get_blueprint_library().find(actor.record.blueprint)
    body = world.spawn_actor(blueprint, _transform(carla, t, 0, lift_m=1.0))
    body.set_simulate_physics(False)
    return body


def _driven(
    carla: Any, world: Any, bodies: list[Any], motions: tuple[Trajectory, ...]
) -> list[Trajectory]:  # pragma: no cover - needs a server
    rows: list[list[tuple[float, float, float]]] = [[] for _ in bodies]
    try:
        for k in range(len(motions[0].t_s)):
            for body, t in zip(bodies, motions, strict=True):
                body.set_transform(_transform(carla, t, k))
            world.tick()
            for seen, body in zip(rows, bodies, strict=True):
                seen.append(_pose(body.get_transform()))
    finally:
        for body in bodies:
            body.destroy()
    return [_seen(t, np.array(seen)) for t, seen in zip(motions, rows, strict=True)]


def _transform(carla: Any, t: Trajectory, k: int, lift_m: float = 0.1) -> Any:  # pragma: no cover - needs a server
    place = carla.Location(x=float(t.x_m[k]), y=-float(t.y_m[k]), z=lift_m)
    return carla.Transform(place, carla.Rotation(yaw=-math.degrees(float(t.heading_rad[k]))))


def _pose(transform: Any) -> tuple[float, float, float]:  # pragma: no cover - needs a server
    return transform.location.x, -transform.location.y, -math.radians(transform.rotation.yaw)


def _seen(t: Trajectory, rows: Floats) -> Trajectory:  # pragma: no cover - needs a server
    return t.model_copy(update={"x_m": rows[:, 0], "y_m": rows[:, 1], "heading_rad": np.unwrap(rows[:, 2])})
