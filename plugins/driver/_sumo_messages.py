"""Messages between the SUMO driver and its worker process. Imports no libsumo, which takes half a second."""

from __future__ import annotations

from typing import Literal, NamedTuple


class Place(NamedTuple):
    """A box and how it moves; metres, radians counter-clockwise from east, m/s."""

    x_m: float
    y_m: float
    heading_rad: float
    speed_mps: float
    length_m: float
    width_m: float


class Habits(NamedTuple):
    """Parameters of SUMO's car-following model."""

    model: Literal["IDM", "Krauss"]
    acceleration_mps2: float
    braking_mps2: float
    hardest_mps2: float
    headway_s: float
    gap_m: float


class Mover(NamedTuple):
    """Another road user: its place, and the edges of its assumed route (`known`: it drives on them)."""

    id: str
    place: Place
    route: tuple[str, ...]
    known: bool


class Begin(NamedTuple):
    """Begins a drive: the roads, and the ego on its route."""

    net_xml: str
    ego: Place
    route: tuple[str, ...]
    habits: Habits


class Step(NamedTuple):
    """Asks for the next step: the others' places, the ego's speed, and the free speed at this place."""

    movers: tuple[Mover, ...]
    own_mps: float
    free_mps: float


class End(NamedTuple):
    """Ends the drive."""


Order = Begin | Step | End
