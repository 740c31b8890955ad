"""Plays the scenario file in esmini, an independent player.

The binary is the user's: named by `path`, by the variable ESMINI, or found on PATH. It runs without a window, in a
folder of its own, with limits. `_esmini_log` reads its log.
"""

from __future__ import annotations

import signal
import subprocess
from contextlib import suppress
from pathlib import Path

from pydantic import Field

from plugins.simulator._esmini_log import complaints, trajectories
from sgcad_core import settings
from sgcad_core.case.records import Execution, RoadNetwork, Scenario
from sgcad_core.errors import MissingTool, ProcessDied, SimulationFailed
from sgcad_core.execution.playback import execution_of
from sgcad_core.formats.openscenario.playing.player import DT_S
from sgcad_core.interfaces import Simulator
from sgcad_core.system.subprocess_limits import run_limited
from sgcad_core.system.temp_folders import temp_folder

LOG = "log.csv"
MEMORY_MB = 4_000


class Esmini(Simulator):
    """Executes the scenario in esmini with a fixed step of 0.05 s; needs a binary that the user installs."""

    path: str = ""
    """The binary; without it the variable ESMINI, else `esmini` on PATH."""
    timeout_s: float = Field(60.0, gt=0, le=3600)
    """Longest wait for one scenario."""
    options: tuple[str, ...] = ()
    """More of esmini's options, such as --pline_interpolation segment."""

    @property
    def stamp(self) -> str:
        """The binary's size and time: results of another build are not reused."""
        with suppress(MissingTool, OSError):
            about = self._binary().stat()
            return f"{about.st_size}-{about.st_mtime_ns}"
        return ""

    def ready(self) -> None:
        """Raises MissingTool where there is no binary."""
        self._binary()

    def execute(self, scenario: Scenario, network: RoadNetwork) -> Execution:
        """Play the .xosc on the .xodr. Raises MissingTool, SimulationFailed with esmini's words."""
        if scenario.xosc is None or network.xodr is None:
            raise SimulationFailed("esmini needs an .xosc and an .xodr; for SUMO route files use simulator 'libsumo'")
        with temp_folder("esmini") as folder:
            (folder / "scenario.xosc").write_text(scenario.xosc, encoding="utf-8")
            (folder / "road.xodr").write_text(network.xodr, encoding="utf-8")
            said = self._run(folder)
            log = folder / LOG
            if not log.is_file():
                raise SimulationFailed(f"esmini wrote no log; its last words: {_last(said)}")
            seen = trajectories(log.read_text("utf-8", "replace"), [a.id for a in scenario.actors], DT_S)
        execution = execution_of("esmini", scenario, seen)
        return execution.model_copy(update={"complaints": complaints(said)})

    def _run(self, folder: Path) -> str:
        """esmini's messages. Raises SimulationFailed."""
        command = [str(self._binary()), "--osc", "scenario.xosc", "--headless", "--disable_log"]
        command += ["--fixed_timestep", f"{DT_S:g}", "--csv_logger", LOG, *self.options]
        try:
            done = run_limited(command, folder, settings.plain_environment(), self.timeout_s, memory_mb=MEMORY_MB)
        except subprocess.TimeoutExpired as fault:
            raise SimulationFailed(f"esmini did not end within {self.timeout_s:g} s") from fault
        except OSError as fault:
            raise SimulationFailed(f"{command[0]} cannot be started: {fault.strerror}") from fault
        said = (done.stdout + done.stderr).decode("utf-8", "replace")
        if done.returncode < 0:
            raise ProcessDied(f"esmini died of {_signal(-done.returncode)}; its last words: {_last(said)}")
        if done.returncode:
            raise SimulationFailed(f"esmini ended with {done.returncode}; its last words: {_last(said)}")
        return said

    def _binary(self) -> Path:
        return settings.program("esmini", self.path, "ESMINI", "https://github.com/esmini/esmini/releases")


def _signal(number: int) -> str:
    with suppress(ValueError):
        return signal.Signals(number).name
    return f"signal {number}"


def _last(said: str) -> str:
    """Complaints if there are any, else the last lines."""
    lines = complaints(said) or tuple(said.strip().splitlines()[-3:])
    return "; ".join(lines)[:500] or "none"
