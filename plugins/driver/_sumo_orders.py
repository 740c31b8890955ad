"""What the SUMO driver and its worker process say to each other. Imports no libsumo: it costs half a second."""

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
    """Another road user: where it is, and the edges that it is thought to take (`known`: it drives on them)."""

    id: str
    place: Place
    route: tuple[str, ...]
    known: bool


class Begin(NamedTuple):
    """A drive begins: the roads, and the ego on its route."""

    net_xml: str
    ego: Place
    route: tuple[str, ...]
    habits: Habits


class Step(NamedTuple):
    """The next step: where the others are, how fast the ego is, and how fast the road lets it drive here."""

    movers: tuple[Mover, ...]
    own_mps: float
    free_mps: float


class End(NamedTuple):
    """The drive is over."""


Order = Begin | Step | End
