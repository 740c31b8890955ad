"""The frozen records that one case hands from stage to stage.

Knows specs and numpy; no file format, no plugin, no Prefect. Units are SI; angles in radians,
counter-clockwise from east; the point of an actor is the centre of its bounding box.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sgcad_core.case.evidence import Context as Context
from sgcad_core.case.evidence import CrashReport as CrashReport
from sgcad_core.case.evidence import Diagram as Diagram
from sgcad_core.findings import Finding as Finding
from sgcad_core.findings import Hold as Hold
from sgcad_core.findings import Severity as Severity
from sgcad_core.kinds import ActorRecord, actor_kind
from sgcad_core.record_base import Record as Record
from sgcad_core.records.facts import Fact as Fact
from sgcad_core.records.place import LaidLeg as LaidLeg
from sgcad_core.records.place import MapLeg as MapLeg
from sgcad_core.records.place import MapPlace as MapPlace
from sgcad_core.records.place import Place as Place
from sgcad_core.records.place import PlaceFact as PlaceFact
from sgcad_core.records.second_reader import Heard as Heard
from sgcad_core.records.second_reader import Opinion as Opinion
from sgcad_core.records.second_reader import Weights as Weights
from sgcad_core.records.specs import ActorKind, Area, BehaviorSpec, Contact, Maneuver, NearCrash, RoadLayout, RoadSpec

Floats = NDArray[np.float64]
Stage = Literal["road", "scenario"]
Source = Literal["written", "openstreetmap", "map_library"]
"""Where a road network's shape comes from: drawn for the report, a real junction, a map that existed before."""


# ------------------------------------------------------------------ questions and answers
class Passage(Record):
    """A retrieved piece of knowledge; stands in the query, so in both rows."""

    id: str
    kind: str
    text: str
    score: float = 0.0
    data: str = Field("", repr=False)
    """JSON for programs, such as a real junction's legs and plain XML; never part of a prompt."""


class Query(Record):
    """CAD's x: everything but the evidence.

    Prompt order, made for prefix reuse: task, passages | evidence (context) | repair.
    """

    task: str
    passages: tuple[Passage, ...] = ()
    answer_schema: Mapping[str, Any] | None = None
    """JSON schema of the answer; a backbone with a grammar cannot answer otherwise."""
    repair: str = ""
    """The previous answer and its findings, empty on the first attempt: stands last."""
    attempt: int = 1
    case: str = ""
    stage: Stage | None = None
    """Labels for logs and scripted answers; never part of a prompt."""


class Token(Record):
    """One answer token; `forced` marks tokens that the grammar left no choice about."""

    text: str
    logp_with_context: float
    logp_without_context: float | None = None
    forced: bool = False


class Conflict(Record):
    """A token at which evidence and prior disagreed: the best token of either row, and the one that was written."""

    field: str
    """JSON path of the field that the token belongs to."""
    evidence: str
    prior: str
    chosen: str

    @property
    def winner(self) -> Literal["evidence", "prior", "neither"]:
        """Whose token was written."""
        return "evidence" if self.chosen == self.evidence else "prior" if self.chosen == self.prior else "neither"

    def line(self) -> str:
        """One line: the field, both tokens, and which was written."""
        written = f", written {self.chosen!r}" if self.winner == "neither" else ""
        return f"{self.field}: evidence {self.evidence!r}, prior {self.prior!r}{written} ({self.winner})"


class Generation(Record):
    """A model's answer with its tokens and cost."""

    text: str
    tokens: tuple[Token, ...] = ()
    finish: Literal["stop", "length", "refused"] = "stop"
    grounding: Mapping[str, float] = {}
    """JSON path of an answer field -> log p(y|c,x) - log p(y|x) summed over its tokens, nats."""
    told: Mapping[str, float] = {}
    """The same path -> probability that the evidence tells the value, by heads of the model's own; empty without."""
    conflicts: tuple[Conflict, ...] = ()
    """Where the rows with and without the evidence wanted other tokens, in order; empty with one row."""
    prompt_tokens: int = 0
    model_calls: int = 0
    seconds: float = 0.0
    notes: tuple[str, ...] = ()


# ------------------------------------------------------------------ road
class PlainXml(Record):
    """SUMO plain XML: the three inputs of netconvert (connections may be empty)."""

    nodes: str
    edges: str
    connections: str = ""


class RoadNetwork(Record):
    """A road network in both formats. A writer whose XML does not compile leaves net_xml and xodr None."""

    plain: PlainXml | None = None
    spec: RoadSpec | None = None
    layout: RoadLayout | None = None
    """The layout that `spec` was drawn from, where the writer answered one."""
    source: Source = "written"
    place: Place | None = None
    """What came of looking for the report's place in maps; None where no maps were given."""
    net_xml: str | None = Field(None, repr=False)
    xodr: str | None = Field(None, repr=False)
    log: str = ""
    """The messages of netconvert."""
    returncode: int = 0


# ------------------------------------------------------------------ scenario and its execution
class ActorInfo(Record):
    """An actor as result.json names it."""

    id: str
    type: ActorKind
    length_m: float
    width_m: float
    maneuver: Maneuver

    @property
    def record(self) -> ActorRecord:
        """What is known of its kind."""
        return actor_kind(self.type)


def sizes_of(actors: Iterable[ActorInfo]) -> dict[str, tuple[float, float]]:
    """Length and width of each by its id, metres."""
    return {actor.id: (actor.length_m, actor.width_m) for actor in actors}


class Trajectory(Record):
    """One actor's motion on the common clock; equally long arrays, t_s[k] = 0.05 k."""

    actor: str
    t_s: Floats
    x_m: Floats
    y_m: Floats
    heading_rad: Floats
    speed_mps: Floats
    roll_rad: Floats | None = None
    """About its long axis, positive to the right; None: on its wheels all the way."""

    @property
    def pose(self) -> Floats:
        """(n, 3) x, y and heading."""
        return np.column_stack((self.x_m, self.y_m, self.heading_rad))

    @property
    def points(self) -> Floats:
        """(n, 2) x and y."""
        return np.column_stack((self.x_m, self.y_m))

    @property
    def rolls(self) -> Floats:
        """Roll at every instant, radians."""
        return np.zeros(len(self.t_s)) if self.roll_rad is None else self.roll_rad


class ObservedContact(Record):
    """The first overlap of two boxes; areas as `sgcad_core.geometry.plane.contact_area` tells them."""

    actor: str
    other: str
    actor_area: Area
    other_area: Area
    t_s: float

    def is_of(self, contact: Contact) -> bool:
        """Whether it is between the actors of a declared contact, on the declared areas."""
        seen = {self.actor: self.actor_area, self.other: self.other_area}
        return seen == {contact.striker: contact.striker_area, contact.struck: contact.struck_area}


class ClosestApproach(Record):
    """The least distance between the outlines of two boxes, metres (0 on contact), and the first time of it."""

    actor: str
    other: str
    clearance_m: float
    t_s: float


class Scenario(Record):
    """An executable scenario. Exactly one of xosc and routes_xml is written."""

    xosc: str | None = Field(None, repr=False)
    routes_xml: str | None = Field(None, repr=False)
    actors: tuple[ActorInfo, ...]
    behavior: BehaviorSpec | None = None
    declared: Contact | None = None
    near_crash: NearCrash | None = None
    """Of a report without a contact; `declared` is then None."""
    planned: tuple[Trajectory, ...] = Field((), repr=False)
    oddity: float = 0.0
    """How far from ordinary driving the actors must go to meet as declared (`Plan.oddity`)."""
    notes: tuple[str, ...] = ()


class Execution(Record):
    """The result of a simulator: trajectories and the first contact."""

    simulator: str
    trajectories: tuple[Trajectory, ...] = Field(repr=False)
    contact: ObservedContact | None = None
    """First contact between any two actors that move or are struck; None if nothing touched."""
    log: str = ""
    complaints: tuple[str, ...] = ()
    """Features that the simulator reported as unsupported, though it ran."""


# ------------------------------------------------------------------ judgement
class Evidence(Record):
    """The evidence that a validator compares an artifact with."""

    report: CrashReport
    """With `reading`: what the rules read of it."""
    network: RoadNetwork | None = None
    """The written network while the scenario stage is judged."""
    generation: Generation | None = None


class Attempt(Record):
    """One turn of the refinement loop, kept in attempts/<stage>-<nn>/."""

    stage: Stage
    number: int
    prompt: str = ""
    answer: str = ""
    held: tuple[Hold, ...] = ()
    """Restrictions of its answer's schema by earlier findings."""
    findings: tuple[Finding, ...] = ()
    generation: Generation | None = None
    seconds: float = 0.0


class StageOutcome(Record):
    """How a stage ended: all three ends are results and are counted."""

    stage: Stage
    status: Literal["written", "refused", "exhausted"]
    artifact: RoadNetwork | Scenario | None = None
    attempts: tuple[Attempt, ...] = ()
    kept: int = 0
    """Number of the attempt that the artifact is from; 0: none is."""
    reason: str = ""
    missing: tuple[str, ...] = ()

    @property
    def told_by(self) -> Attempt | None:
        """The attempt whose answer stands: the one kept, else the last."""
        return self.attempts[self.kept - 1] if self.attempts else None
