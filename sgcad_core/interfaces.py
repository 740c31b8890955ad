"""The whole extension surface: ten plugin kinds, one abstract method each.

A plugin is one frozen pydantic class in one file: its fields are its configuration, its method is its
job, heavy state is a `functools.cached_property`. Register it under the entry-point group
`sgcad.<kind>`; nothing else is needed. Signatures and docstrings only; what a plugin does otherwise is a PluginFault.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict

from sgcad_core import plugin_calls
from sgcad_core.case.driver_io import Seat, Task
from sgcad_core.case.records import (
    Context,
    CrashReport,
    Evidence,
    Execution,
    Finding,
    Generation,
    Passage,
    Query,
    RoadNetwork,
    Scenario,
    Severity,
)
from sgcad_core.case.tracker_arm import Arm
from sgcad_core.case.traffic import Driven, TrafficOrder
from sgcad_core.errors import ConfigError

Ask = Callable[[Context, Query], Generation]
"""How a writer speaks to the model: backbone and decoder are already chosen, the call is recorded."""


class Plugin(BaseModel, ABC):
    """Fields are the configuration; `sgcad plugins show` prints their docstrings. Unknown keys are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    kind: ClassVar[str]
    version: ClassVar[str] = "1"
    """Part of every cache key: raise it when the same inputs give another result."""

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Hold its methods to its kind's interface: raises PluginFault for what they do otherwise."""
        interface = next(base for base in cls.__mro__[1:] if base.__module__ == __name__)
        if cls.kind != "tracker":  # whose faults cost no case
            plugin_calls.hold_to_interface(cls, interface)

    @property
    def stamp(self) -> str:
        """Fingerprint of what the plugin reads beside its fields, such as an index; part of every cache key."""
        return ""

    @property
    def prompts(self) -> tuple[str, ...]:
        """Names of the files in configs/prompts/ that it asks a model with; trackers keep their texts."""
        return ()


class ReportReader(Plugin):
    """Files to evidence."""

    kind = "report_reader"

    @abstractmethod
    def read(self, source: Path) -> CrashReport:
        """Read one case (a folder or a file). Raises BadInput naming file, value and remedy."""


class Retriever(Plugin):
    """Knowledge that both rows see."""

    kind = "retriever"

    @abstractmethod
    def retrieve(self, text: str, task: str) -> tuple[Passage, ...]:
        """Passages for a stage ("road" or "scenario"), best first; empty where nothing is known."""


class Decoder(Plugin):
    """A pure function of the two logit rows: no model, no cache, no state but its fields."""

    kind = "decoder"
    needs_prior: ClassVar[bool]
    """True if `scores` reads the row without context; the backbone then runs both."""

    @abstractmethod
    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        """Combine rows of logits, tensors (rows, vocabulary), into the logits to pick from; -inf excludes."""

    def contrast_context(self, context: Context) -> Context | None:
        """What the second row sees in place of the evidence: nothing, unless a decoder says otherwise."""
        return None

    def reads_prior(self) -> bool:
        """False where the fields switch the contrast off (alpha 0): the second row is then not run."""
        return self.needs_prior

    def at(self, attempt: int) -> Decoder:
        """The decoder of an attempt, from 1: the same one, unless attempts are drawn differently."""
        return self

    def draw(self, scores: Any, generator: Any) -> Any:
        """Pick one token a row, (rows,), from scores behind the grammar; the default takes the best."""
        return scores.argmax(-1)


class Backbone(Plugin):
    """Owns the model, the token loop and the KV caches."""

    kind = "backbone"
    gives_logits: ClassVar[bool]
    """False: cannot be paired with a decoder that needs the prior; refused before weights load."""

    @abstractmethod
    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Answer a query. Thread-safe. Raises InvalidOutput if no valid answer fits."""

    def load(self) -> None:
        """Do now what the first question would wait for; called beside other work, and most have nothing to do.

        What it raises the first question raises again.
        """

    def offers(self, decoder: Decoder) -> tuple[str, ...]:
        """What the service behind it offers that decoder, a line each; most have none behind them.

        Raises ConfigError (it lacks what is needed) or ServerSilent.
        """
        return ()

    def weights_gb(self) -> float | None:
        """Memory that its weights will take on this machine, decimal GB; None: none here, or unknown."""
        return None


class RoadWriter(Plugin):
    """Evidence to a road network."""

    kind = "road_writer"
    asks_model: ClassVar[bool]
    """False: `ask` is never called, so no backbone is needed."""
    mends: ClassVar[tuple[Severity, ...]] = ()
    """Findings about which a writer that asks no model does something, so that a second attempt may be better."""

    @abstractmethod
    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Write (or, with findings, mend) a network. Raises InvalidOutput or Refused."""


class ScenarioWriter(Plugin):
    """Evidence and a road network to a scenario."""

    kind = "scenario_writer"
    asks_model: ClassVar[bool]
    mends: ClassVar[tuple[Severity, ...]] = ()

    @abstractmethod
    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Write (or, with findings, mend) a scenario on that network. Raises InvalidOutput or Refused."""


class Validator(Plugin):
    """Judges one stage's artifact."""

    kind = "validator"
    stage: ClassVar[str]
    """"road", "scenario" or "both": the artifacts it reads. What it cannot judge it passes over: []."""

    def load(self) -> None:
        """Begin now what the first call would wait for; called beside other work, and most have nothing to do."""

    @abstractmethod
    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Everything wrong, worst first; an empty list is a pass. Raises MissingTool only."""


class Simulator(Plugin):
    """Runs a scenario."""

    kind = "simulator"

    @property
    def drives_traffic(self) -> bool:
        """Whether it has drivers of its own, for `drive_traffic`."""
        return type(self).drive_traffic is not Simulator.drive_traffic

    def ready(self) -> None:
        """Called before a batch starts. Raises MissingTool where a program lacks; the default needs none."""
        return

    def load(self) -> None:
        """Begin now what the first call would wait for; called beside other work, and most have nothing to do."""

    @abstractmethod
    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Execute in a process that may die. Raises SimulationFailed."""

    def drive_traffic(self, order: TrafficOrder) -> tuple[Driven, ...]:
        """Background vehicles driven among the actors of a crash, in a process that may die.

        Those that find no room are left out. Raises ConfigError where it has no drivers of its own; SimulationFailed.
        """
        raise ConfigError(f"simulator {type(self).__name__} drives no traffic: take libsumo, or traffic: none")


class Driver(Plugin):
    """Drives one road user of a reconstructed crash in the report's driver's place."""

    kind = "driver"

    @abstractmethod
    def take_over(self, task: Task) -> Seat:
        """A driver for one drive, asked 20 times a second. Raises ConfigError, MissingTool or SimulationFailed."""


class Tracker(Plugin):
    """Where results can be compared. Called from one thread, after the case is on disk, maybe hours after.

    What is logged of a case comes from its folder alone. `begin` and `end` enclose a batch; a batch that was killed is
    begun again, and its logged cases are not logged again. A single `log_case` without them is fine.
    """

    kind = "tracker"

    def ready(self, out: Path) -> None:
        """Called before anything starts, quick. Raises ConfigError where it can never log; the default is ready."""
        return

    def begin(self, arm: Arm) -> None:
        """Called before the first case of a config; the default keeps nothing."""
        return

    @abstractmethod
    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Log one finished case from its folder: parameters, metrics, attempts, steps, files."""

    def page(self, config_name: str, case: str) -> str:
        """Where a case that was logged here is to be seen: an address, or what comes after that of a server over the
        same database (from "/" on); "" where nowhere (the default)."""
        return ""

    def end(self, arm: Arm, finished: bool) -> None:
        """Called after the last case; `finished` is false after an interruption and where a fault ended the batch
        (`arm.fault` says which). The default keeps nothing."""
        return

    def identity(self, out: Path) -> str:
        """Identifies the place where it logs; a place that is made anew at the same address has another identity.

        Cheap, and makes nothing: it is asked for every case, to see whether that case is logged there. Default: "".
        """
        return ""

    def log_training(self, name: str, params: dict[str, Any], lines: Sequence[Mapping[str, Any]]) -> int:
        """Log what is new in a training log, a line with a "step" a row; how many lines that were. Default: none."""
        return 0
