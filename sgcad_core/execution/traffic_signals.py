"""What the signals show to the traffic, a state a row: the scenario's plan, else a phase that suits the actors.

Where the report tells no signal, the scenario has no plan, and SUMO's own program would let the cross traffic drive
into actors that cross. So that program is shifted to where most actors cross on green. Knows the rules' passages and
the lane graph; no simulator.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.roads.lane_graph import Connection, LaneGraph, Program
from sgcad_core.rules.lights import Lights, lights_of
from sgcad_core.rules.passages import passages
from sgcad_core.rules.records import Mover

_LETTERS = {"green": "G", "yellow": "y", "red": "r", "red-yellow": "u", "flashing": "o"}
_OFF = "O"
_YIELDS = ("left", "u_turn")
_PROGRAM_STEP_S = 1.0
"""Shifts of a program that are tried."""


class Shown(NamedTuple):
    """By program its states, a string a row; and what was assumed."""

    states: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...] = ()


def shown_to_traffic(graph: LaneGraph, xosc: str | None, movers: Sequence[Mover], rows: int) -> Shown:
    """The states of all signals of a network. Raises InvalidOutput where the scenario is no XML."""
    if not graph.programs:
        return Shown({})
    if (lights := lights_of(graph, xosc)) is not None:
        return Shown({name: _planned(graph, name, lights, rows) for name in graph.programs})
    crossed = [(p.link, p.line * STEP_S) for mover in movers for p in passages(graph, mover) if p.link.light]
    states, notes = dict[str, tuple[str, ...]](), list[str]()
    for name, program in graph.programs.items():
        mine = [(link, at_s) for link, at_s in crossed if link.light == name]
        shift = _best_shift(program, mine)
        states[name] = tuple(_state(program, k * STEP_S + shift) for k in range(rows))
        notes.append(f"no plan of signal {name} is told: the traffic sees its usual program from second {shift:g} on")
    return Shown(states, tuple(notes))


def _planned(graph: LaneGraph, name: str, lights: Lights, rows: int) -> tuple[str, ...]:
    links = {c.link: c for c in graph.connections if c.light == name}
    width = len(graph.programs[name].phases[0].states)
    return tuple("".join(_letter(links.get(place), lights, k * STEP_S) for place in range(width)) for k in range(rows))


def _letter(link: Connection | None, lights: Lights, t_s: float) -> str:
    shown = lights.at(link, t_s) if link else None
    if link is None or shown is None:
        return "r"  # crosswalks, and connections of which the plan says nothing
    letter = _LETTERS.get(shown.state, _OFF)
    return "g" if letter == "G" and link.direction in _YIELDS else letter


def _best_shift(program: Program, crossed: Sequence[tuple[Connection, float]]) -> float:
    """The first second of a program under which most passages have green, yellow counting half."""
    cycle = sum(phase.duration_s for phase in program.phases)
    shifts = [k * _PROGRAM_STEP_S for k in range(max(int(cycle / _PROGRAM_STEP_S), 1))]

    def score(shift: float) -> float:
        seen = [_state(program, at_s + shift)[link.link] for link, at_s in crossed]
        return sum(1.0 if letter in "Gg" else 0.5 if letter == "y" else 0.0 for letter in seen)

    return max(shifts, key=lambda shift: (score(shift), -shift))


def _state(program: Program, t_s: float) -> str:
    """The letters of a program at a time."""
    rest = t_s % max(sum(phase.duration_s for phase in program.phases), 1e-9)
    for phase in program.phases:
        if rest < phase.duration_s:
            return phase.states
        rest -= phase.duration_s
    return program.phases[-1].states
