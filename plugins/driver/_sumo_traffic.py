"""The far end of the SUMO driver: one vehicle that SUMO drives among others that are put where they are.

Runs in a worker process, since libsumo may take its process along. An order a step comes in, the speed that SUMO chose
goes out. SI units; headings counter-clockwise from east, points are box centers.
"""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

import libsumo

from plugins.driver._sumo_orders import Begin, Habits, Mover, Order, Place, Step
from sgcad_core.case.driver_io import STEP_S
from sgcad_core.errors import SimulationFailed
from sgcad_core.system.temp_folders import temp_folder

_OPTIONS = (
    "--step-length", str(STEP_S), "--collision.action", "none", "--time-to-teleport", "-1", "--xml-validation", "never",
    "--no-step-log", "true", "--duration-log.disable", "true", "--no-warnings", "true",
)  # fmt: skip
EGO = "ego"
_ON_ROUTE, _FREE = 1, 2
_STRAYS_M = 2.0
"""A mover that SUMO puts this far from where it is has left the way that it was thought to go."""
_OFF_LANES_M = 2.5
"""Farther from the center of any lane nobody is in a lane."""
_ANYWHERE_M = 100.0
_NO_LIMIT_MPS = 100.0

_free: set[str] = set()


def obey(order: Order) -> float:
    """Carry out one order; a step answers the ego's speed, m/s. Raises SimulationFailed with SUMO's words."""
    try:
        if isinstance(order, Begin):
            _begin(order)
            return order.ego.speed_mps
        if isinstance(order, Step):
            return _step(order)
        libsumo.close()
        return 0.0
    except libsumo.TraCIException as fault:
        raise SimulationFailed(f"SUMO cannot drive the ego: {fault}") from fault


def _begin(order: Begin) -> None:
    _free.clear()
    with temp_folder("driver") as folder:
        net, routes = folder / "road.net.xml", folder / "types.rou.xml"
        net.write_text(order.net_xml, encoding="utf-8")
        routes.write_text(_types(order.habits), encoding="utf-8")
        libsumo.start(["sumo", "-n", str(net), "-r", str(routes), *_OPTIONS])
    libsumo.route.add(EGO, order.route)
    libsumo.vehicletype.setLength(EGO, order.ego.length_m)
    libsumo.vehicletype.setWidth(EGO, order.ego.width_m)
    libsumo.vehicle.add(EGO, EGO, typeID=EGO)
    libsumo.vehicle.setLaneChangeMode(EGO, 0)
    _put(EGO, order.ego, _ON_ROUTE)
    libsumo.simulationStep()
    for lane in libsumo.lane.getIDList():  # the report's driver's speed, told step by step, is the only limit
        libsumo.lane.setMaxSpeed(lane, _NO_LIMIT_MPS)


def _types(habits: Habits) -> str:
    said = {
        "carFollowModel": habits.model, "accel": habits.acceleration_mps2, "decel": habits.braking_mps2,
        "emergencyDecel": habits.hardest_mps2, "tau": habits.headway_s, "minGap": habits.gap_m, "sigma": 0.0,
        "speedDev": 0.0,
    }  # fmt: skip
    return (
        f"<routes><vType id={quoteattr(EGO)} {' '.join(f'{k}={quoteattr(str(v))}' for k, v in said.items())}/></routes>"
    )


def _step(order: Step) -> float:
    there = set(libsumo.vehicle.getIDList())
    for mover in order.movers:
        if mover.id not in there:
            _add(mover)
        _put(mover.id, mover.place, _ON_ROUTE if _on_route(mover) else _FREE)
        libsumo.vehicle.setSpeed(mover.id, mover.place.speed_mps)
    if EGO in there:
        libsumo.vehicle.setMaxSpeed(EGO, max(order.free_mps, 0.1))
        libsumo.vehicle.setPreviousSpeed(EGO, order.own_mps)  # what the tires allowed of the last answer
    libsumo.simulationStep()
    there = set(libsumo.vehicle.getIDList())
    if EGO not in there:  # behind the end of its roads nobody is ahead
        return order.free_mps
    for mover in order.movers:
        if mover.id in there and _on_route(mover) and _strays(mover):
            _free.add(mover.id)
    return float(libsumo.vehicle.getSpeed(EGO))


def _on_route(mover: Mover) -> bool:
    return mover.known and mover.id not in _free


def _add(mover: Mover) -> None:
    kind = f"type_{mover.id}"
    if kind not in libsumo.vehicletype.getIDList():
        libsumo.vehicletype.copy("DEFAULT_VEHTYPE", kind)
        libsumo.vehicletype.setLength(kind, mover.place.length_m)
        libsumo.vehicletype.setWidth(kind, mover.place.width_m)
        libsumo.vehicletype.setMinGap(kind, 0.0)
        libsumo.route.add(mover.id, mover.route)
    libsumo.vehicle.add(mover.id, mover.id, typeID=kind)
    libsumo.vehicle.setSpeedMode(mover.id, 0)
    libsumo.vehicle.setLaneChangeMode(mover.id, 0)


def _put(name: str, place: Place, keep: int) -> None:
    angle = (90.0 - math.degrees(place.heading_rad)) % 360.0
    near = _OFF_LANES_M if keep == _FREE else _ANYWHERE_M
    libsumo.vehicle.moveToXY(name, "", -1, *_front(place), angle=angle, keepRoute=keep, matchThreshold=near)


def _strays(mover: Mover) -> bool:
    return math.dist(libsumo.vehicle.getPosition(mover.id), _front(mover.place)) > _STRAYS_M


def _front(place: Place) -> tuple[float, float]:
    """The middle of the front bumper, SUMO's point of a vehicle."""
    reach = place.length_m / 2
    return place.x_m + reach * math.cos(place.heading_rad), place.y_m + reach * math.sin(place.heading_rad)
