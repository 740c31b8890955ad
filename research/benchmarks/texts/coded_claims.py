"""Whether codes call a claim right: values of `sgcad_core.reading.second_reader.field_claims` against a line of a pool.

None where no code judges it. A heading is judged by the turn between the first two vehicles, the other one heading as
the rules have it; legs by whether roads meet; lanes by the coded roads of the vehicles on that axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from research.benchmarks.texts.coded_cases import is_vehicle, kept_events, lanes_fit
from research.rows.numbered_rows import codes_of, lanes_told
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.second_reader.numbered.numbered_answers import MANEUVERS, relative, same

JUDGED = ("maneuver", "contact", "areas", "heading", "legs", "lanes", "control")
"""Kinds of fields that codes judge."""


class Judge:
    """The codes of one line, for claims about its text."""

    def __init__(self, case: Mapping[str, Any], reading: Reading) -> None:
        self.case, self.reading, self.codes = case, reading, codes_of(case, reading)

    def right(self, key: str, value: Any) -> bool | None:
        """Whether a value of a field is right; None: not coded."""
        kind, _, of = key.partition(".")
        if kind == "maneuver":
            return self._answers(key, MANEUVERS[value])
        if kind == "legs":
            return self._answers("junction", "yes" if len(value) > 2 else "no")
        if kind == "heading":
            return self._heading(of, value)
        if kind == "lanes":
            return self._lanes(of, value)
        if kind == "control":
            return self._control(value)
        return {"contact": self._contact, "areas": self._areas}[kind](value) if kind in ("contact", "areas") else None

    def _answers(self, question: str, answer: str) -> bool | None:
        allowed = self.codes.get(question)
        return None if allowed is None else any(same(one, answer) for one in allowed)

    def _heading(self, of: str, value: Any) -> bool | None:
        one, two = (self.reading.crash.vehicle(name) for name in ("V1", "V2"))
        if "turned.V2" not in self.codes or one is None or two is None or of not in ("V1", "V2"):
            return None
        one, two = (replace(v, heading=value) if v.id == of else v for v in (one, two))
        turn = relative(one, two)
        return None if turn is None else self._answers("turned.V2", turn)

    def _lanes(self, axis: str, value: Any) -> bool | None:
        roads = [road for road in self.case["network"]["roads"] if lanes_told(road)]
        vehicles = {v.id: v for v in self.reading.crash.vehicles}
        here = [
            road
            for road in roads
            if (v := vehicles.get(road["vehicle"])) is not None and v.heading and axis_of(v.heading) == axis
        ]
        ways = [(inward, out) for _, inward, out in value]
        return all(lanes_fit(road, ways) for road in here) if here else None

    def _control(self, value: Any) -> bool | None:
        network = self.case["network"]
        told = {road["control"] for road in network["roads"] if road["told"]["control"]}
        if network["control"] not in told & {"signal", "stop"}:
            return None
        return network["control"] in {kind for _, kind in value}

    def _contact(self, value: Any) -> bool | None:
        first = next(iter(kept_events(self.case["events"])), None)
        if first is None or not is_vehicle(first["other"]):
            return None
        return {*value} == {first["actor"], first["other"]}

    def _areas(self, value: Any) -> bool | None:
        coded = {key.partition(".")[2]: one for key, (one, *_) in self.codes.items() if key.startswith("area.")}
        sides = dict(value)
        if not coded or not coded.keys() <= sides.keys():
            return None
        return all(sides[vehicle] == side for vehicle, side in coded.items())
