"""The model writes Python on scenariogeneration; it runs in the sandbox, and its scenario is the .xosc.

The paper's own method. Beside the code the model declares actors and contacts as JSON, so that the execution can be
compared with the intention. An exception goes back with its line and the nearest entry of the API.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from plugins.scenario_writer._api_hint import nearest_entry
from plugins.scenario_writer._network_words import lane_lines
from plugins.scenario_writer.sandbox.script_runner import Fault, Limits, run_script
from sgcad_core.asking.fenced_blocks import fenced_blocks
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import ActorInfo, Context, Finding, Passage, Query, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.playing.player import entity_boxes
from sgcad_core.formats.openscenario.playing.timed_motion import BoxShape
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import Ask, ScenarioWriter
from sgcad_core.kinds import actor_kind
from sgcad_core.records.specs import ActorId, ActorKind, Contact, Maneuver, Spec
from sgcad_core.roads.describe import describe_network


class CodedActor(Spec):
    """An actor that the code moves; its box is the code's."""

    id: ActorId = Field(description="the entity's name in the code; V<n> as the report numbers it")
    kind: ActorKind
    maneuver: Maneuver


class Declaration(Spec):
    """The actors, and the contacts in order of time."""

    actors: tuple[CodedActor, ...] = Field(min_length=1, max_length=12)
    contacts: tuple[Contact, ...] = Field((), max_length=8)


class CodeAnswer(Declaration):
    """The envelope: the declaration and the script in one JSON object."""

    code: str = Field(description="the whole Python script")


class Code(ScenarioWriter):
    """Asks a model for a Python script and a declaration of actors and contacts, and runs the script in the sandbox.

    form is how they are answered (fenced blocks or a JSON envelope); cpu_s, wall_s and memory_mb limit the script.
    """

    asks_model: ClassVar[bool] = True
    form: Literal["fenced", "envelope"] = "fenced"
    prompt: str = Field("code", pattern=r"^[\w-]+$")
    """configs/prompts/<prompt>.md; its slots {answer}, {roads} and {lanes} are filled."""
    allow_without_namespace: bool = False
    """Run scripts where the system gives no network namespace: the sandbox's other walls must do."""
    cpu_s: int = Field(5, ge=1, le=60)
    wall_s: float = Field(15.0, gt=0, le=120)
    memory_mb: int = Field(512, ge=128, le=4096)

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt and the words on the form of the answer."""
        return (self.prompt, f"{self.prompt}_{self.form}")

    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Asks, reads and runs. Raises InvalidOutput with findings, Refused, ConfigError (no isolation)."""
        query = Query(
            task=self._task(network),
            passages=tuple(passages),
            answer_schema=answer_schema(CodeAnswer) if self.form == "envelope" else None,
            attempt=attempt,
        )
        declared, code = _read(ask(context, query).text)
        return self._scenario(declared, self._run(code))

    def _task(self, network: RoadNetwork) -> str:
        if network.net_xml is None:
            raise InvalidOutput("the road network has no net.xml: no lane to place an actor on")
        graph = parse_net(network.net_xml)
        return load_prompt(
            self.prompt,
            answer=load_prompt(f"{self.prompt}_{self.form}"),
            roads=describe_network(network.spec or graph),
            lanes=lane_lines(graph, network.xodr),
        )

    def _run(self, code: str) -> str:
        limits = Limits(self.cpu_s, self.wall_s, self.memory_mb)
        ran = run_script(code, limits, allow_without_namespace=self.allow_without_namespace)
        if ran.xosc is None:
            faults = _findings(ran.fault or Fault("execution"), code.splitlines())
            raise InvalidOutput("\n".join(f.line() for f in faults), faults)
        return ran.xosc

    def _scenario(self, declared: Declaration, xosc: str) -> Scenario:
        try:
            boxes = dict(entity_boxes(xosc))
        except InvalidOutput:  # the validators say so with the whole list of faults
            boxes = {}
        actors = tuple(_actor(actor, boxes.get(actor.id)) for actor in declared.actors)
        return Scenario(xosc=xosc, actors=actors, declared=declared.contacts[0] if declared.contacts else None)


def _actor(actor: CodedActor, box: BoxShape | None) -> ActorInfo:
    length, width = (box.length_m, box.width_m) if box else actor_kind(actor.kind).size
    return ActorInfo(id=actor.id, type=actor.kind, length_m=length, width_m=width, maneuver=actor.maneuver)


# ------------------------------------------------------------------ the answer
def _read(answer: str) -> tuple[Declaration, str]:
    """Declaration and script, in whichever form they came. Raises Refused, InvalidOutput."""
    blocks = [b for b in fenced_blocks(answer) if b.language in ("python", "py", "python3")]
    if not blocks:
        envelope = parse_answer(answer, CodeAnswer)
        return envelope, envelope.code
    block = blocks[-1]
    return parse_answer(answer[: block.start] + answer[block.end :], Declaration), block.text


# ------------------------------------------------------------------ what went wrong
_SOURCES = {"parse": "python_syntax", "rules": "python_rules", "execution": "python", "limit": "python_limit"}


def _findings(fault: Fault, lines: Sequence[str]) -> list[Finding]:
    source = _SOURCES[fault.layer]
    if fault.breaches:
        return [
            Finding(source=source, what=what, where=_where(line, lines), value=value, remedy=remedy)
            for line, what, value, remedy in fault.breaches
        ]
    what = ": ".join(part for part in (fault.kind, fault.message) if part)
    return [Finding(source=source, what=what, where=_where(fault.line, lines), remedy=_remedy(fault, lines))]


def _remedy(fault: Fault, lines: Sequence[str]) -> str:
    if fault.layer == "limit":
        return "place the actors with few statements; no loop needs more than a second"
    if fault.layer == "parse":
        return "give one whole Python script"
    entry = nearest_entry(fault.kind, fault.message, _line(fault.line, lines))
    return f"nearest in the API: {entry}" if entry else "mend this line"


def _where(number: int | None, lines: Sequence[str]) -> str:
    shown = _line(number, lines).strip()[:120]
    return "" if number is None else f"line {number}" + (f": {shown}" if shown else "")


def _line(number: int | None, lines: Sequence[str]) -> str:
    return lines[number - 1] if number and 0 < number <= len(lines) else ""
