"""What the LibSumo simulator and its worker process say to each other. Imports no libsumo: it costs 0.5 s."""

from __future__ import annotations

from typing import NamedTuple

from sgcad_core.case.records import Floats


class Mover(NamedTuple):
    """One actor to replay: box in metres, poses (n, 4)."""

    id: str
    length_m: float
    width_m: float
    poses: Floats


class Replayed(NamedTuple):
    """Poses read back from SUMO, one array a mover, and what SUMO could not hold."""

    poses: tuple[Floats, ...]
    notes: tuple[str, ...]


class Driven(NamedTuple):
    """Poses of actors that SUMO drove itself, (n, 4) each on one clock, and what SUMO said."""

    poses: tuple[Floats, ...]
    notes: tuple[str, ...]
