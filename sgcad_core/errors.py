"""Every error the project raises on purpose, one class per reaction.

    SgcadError
    ├── ConfigError        edit the YAML or the command line          (exit 2, nothing started)
    ├── BadInput           this report cannot be read: mend the file  (the case fails, the batch goes on)
    ├── MissingTool        install what is named                      (exit 2, nothing started)
    │   └── ServerSilent   a server gave no answer: tried again       (then as MissingTool)
    ├── InvalidOutput      the writer's output is wrong: ask again    (caught by the refinement loop)
    │   └── Unsupported    right, but more than our player plays      (named with its line, never left out silently)
    ├── WrongEdit          a person's fact cannot be taken: give another (result and facts.yaml stay as they were)
    ├── Refused            the evidence does not carry the crash      (a result, never retried)
    ├── NoTraffic          no room for traffic around this crash      (the crash stays as it is, without it)
    ├── PluginFault        a plugin broke its interface: mend it      (the case fails at once, the batch goes on)
    └── SimulationFailed   the execution died: may be retried         (the case fails, the batch goes on)
        └── ProcessDied    killed or crashed, not late: once more     (a second death is the case's failure)

A message says what, the value, the limit and the remedy. Knows nothing else of the project.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sgcad_core.findings import Finding


class SgcadError(Exception):
    """Root of the tree; never raised itself."""


class ConfigError(SgcadError):
    """The configuration or the command line is wrong; the message lists every fault found."""


class BadInput(SgcadError):
    """A report cannot be read; the message names the file, the value and the remedy."""


class MissingTool(SgcadError):
    """A program or package is not installed; the message says how to install it."""


class ServerSilent(MissingTool):
    """A server gave no answer, after the tries of the plugin that asked it; a step that met it may be repeated."""


class InvalidOutput(SgcadError):
    """A writer produced something that cannot be used; `findings` go back to the model."""

    def __init__(self, message: str, findings: Sequence[Finding] = ()) -> None:
        super().__init__(message)
        self.findings = tuple(findings)

    @classmethod
    def of(cls, *findings: Finding) -> Self:
        """The error of these findings, one line each."""
        return cls("\n".join(finding.line() for finding in findings), findings)


class Unsupported(InvalidOutput):
    """A scenario uses what our player lacks; `element` names it, the finding its line and what would help."""

    def __init__(self, message: str, findings: Sequence[Finding] = (), element: str = "") -> None:
        super().__init__(message, findings)
        self.element = element


class WrongEdit(SgcadError):
    """A person's fact cannot be taken; `findings` say what it brings about, nothing was changed."""

    def __init__(self, message: str, findings: Sequence[Finding] = ()) -> None:
        super().__init__(message)
        self.findings = tuple(findings)


class Refused(SgcadError):
    """The model, a writer or the evidence gate declines; `missing` names the evidence that lacks."""

    def __init__(self, reason: str, missing: Sequence[str] = ()) -> None:
        super().__init__(reason)
        self.reason = reason
        self.missing = tuple(missing)


class NoTraffic(SgcadError):
    """A crash has no room for traffic; the message says why. The crash itself is not concerned."""


class PluginFault(SgcadError):
    """A plugin raised what its kind may not raise, or returned something else; the message names it and its place."""


class SimulationFailed(SgcadError):
    """A simulator died or gave no trajectory; the message carries its last words."""


class ProcessDied(SimulationFailed):
    """A worker process was killed or crashed within its time limit; the report need not be the cause.

    `from_outside`: a signal that no crash sends ended it: a kill, or the system's lack of memory.
    """

    def __init__(self, message: str, *, from_outside: bool = False) -> None:
        super().__init__(message)
        self.from_outside = from_outside
