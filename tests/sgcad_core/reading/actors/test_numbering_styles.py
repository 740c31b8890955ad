"""Vehicles are found however a report numbers them: each style gives the facts of V1 and V2."""

from functools import cache

import pytest

from sgcad_core.reading.reading import read

REPORT = (
    "{a} was traveling northbound on Oak Street. {b} was traveling westbound on Elm Street and was turning left "
    "onto Oak Street. The front of {a} struck the left side of {b}. {x} stated that {y} pulled out."
)
VEHICLES = (
    "MV{n}", "MV {n}", "MV#{n}", "M/V {n}", "Veh{n}", "Veh {n}", "Veh. {n}", "Veh.#{n}", "V-{n}", "V#{n}", "V {n}",
    "v{n}", "V/{n}", "V.{n}", "CV{n}", "TU{n}", "VEH {n}", "Vehicle{n}", "Vehicle#{n}", "Vehicle No. {n}",
    "Vehicle-{n}", "Vehical {n}", "motor vehicle #{n}", "Unit {n}", "Unit #{n}", "Unit-{n}", "Unit{n}",
    "Traffic Unit {n}", "U{n}", "U-{n}", "U#{n}", "#{n}", "No. {n}", "the #{n} vehicle", "Car {n}", "Car #{n}",
    "Vehicle {word}", "Unit {word}", "Vehicle {letter}", "Unit {letter}",
)  # fmt: skip
DRIVERS = (
    "Driver {n}", "Driver #{n}", "Driver-{n}", "Driver {word}", "D{n}", "D-{n}", "Operator {n}", "Operator #{n}",
    "Op {n}", "OP{n}", "Oper. {n}", "Party {n}",
)  # fmt: skip


def told(a: str, b: str, x: str, y: str) -> dict[str, object]:
    facts = read(REPORT.format(a=a, b=b, x=x, y=y)).facts
    wanted = ("heading", "maneuver", "striker", "struck", "striker_area", "struck_area")
    return {f.field: f.value for f in facts if f.field.rpartition(".")[2] in wanted}


@cache
def plain() -> dict[str, object]:
    facts = told("V1", "V2", "The driver of V1", "the driver of V2")
    assert facts["vehicles.V2.maneuver"] == "turn_left"
    assert facts["contacts.0.struck_area"] == "left"
    return facts


def _named(style: str) -> list[str]:
    return [style.format(n=n, word=w, letter=c) for n, w, c in ((1, "one", "A"), (2, "two", "B"))]


@pytest.mark.parametrize("style", VEHICLES)
def test_vehicles_by_number(style: str) -> None:
    a, b = _named(style)
    assert told(a, b, f"The driver of {a}", f"the driver of {b}") == plain()


@pytest.mark.parametrize("style", DRIVERS)
def test_drivers_by_number(style: str) -> None:
    a, b = _named(style)
    assert told(a, b, a, b) == plain()
