"""One run of SUMO through libsumo, and SUMO's reference points. For worker processes only: libsumo may end its process.

SUMO's point of a vehicle is the middle of the front bumper and its angle runs clockwise from north in degrees; here
points are box centers and headings run counter-clockwise from east in radians.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import libsumo

from sgcad_core.system.temp_folders import temp_folder

QUIET = ("--no-step-log", "true", "--duration-log.disable", "true")
AS_TOLD = ("--time-to-teleport", "-1", "--xml-validation", "never")
"""No vehicle is removed from a jam, and no schema is fetched."""
COLLISIONS = ("--collision.action", "warn", "--collision.check-junctions", "true", "--collision.mingap-factor", "0")
FAULTS = (libsumo.TraCIException, libsumo.FatalTraCIError, RuntimeError)


def start(options: tuple[str, ...], net_xml: str, routes_xml: str = "", step_s: float | None = None) -> None:
    """Starts SUMO on a network and vehicle types, of which it reads all at once. Raises libsumo's errors."""
    with temp_folder("sumo") as folder:
        libsumo.start(_command(folder, options, net_xml, routes_xml, step_s))


@contextmanager
def running(
    options: tuple[str, ...], net_xml: str, routes_xml: str = "", step_s: float | None = None
) -> Iterator[None]:
    """SUMO on a network and, if given, a route file, which it reads as it runs; closed at the end of the block."""
    with temp_folder("sumo") as folder:
        try:
            libsumo.start(_command(folder, options, net_xml, routes_xml, step_s))
            yield
        finally:
            libsumo.close()


def _command(folder: Path, options: tuple[str, ...], net_xml: str, routes_xml: str, step_s: float | None) -> list[str]:
    net, routes = folder / "road.net.xml", folder / "scenario.rou.xml"
    net.write_text(net_xml, encoding="utf-8")
    routes.write_text(routes_xml, encoding="utf-8")
    with_routes = ["-r", str(routes)] if routes_xml else []
    step = ["--step-length", str(step_s)] if step_s else []
    return ["sumo", "-n", str(net), *with_routes, *step, *options]


def front_bumper(x_m: float, y_m: float, heading_rad: float, length_m: float) -> tuple[float, float]:
    """SUMO's point of a box with that center."""
    reach = length_m / 2
    return x_m + reach * math.cos(heading_rad), y_m + reach * math.sin(heading_rad)


def box_center(front: tuple[float, float], heading_rad: float, length_m: float) -> tuple[float, float]:
    """The center of the box whose front bumper is there."""
    reach = length_m / 2
    return front[0] - reach * math.cos(heading_rad), front[1] - reach * math.sin(heading_rad)


def sumo_angle(heading_rad: float) -> float:
    """A heading as SUMO's angle, degrees of [0, 360)."""
    return (90.0 - math.degrees(heading_rad)) % 360.0


def heading_of(angle_deg: float) -> float:
    """SUMO's angle as a heading, radians."""
    return math.radians(90.0 - angle_deg)
