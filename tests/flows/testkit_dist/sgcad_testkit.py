"""Small real plugins for the flow tests, installed like a stranger's distribution.

What they do is said by words in the report: DIE (the process ends), DIE ONCE FILE (it is killed unless the file is
there, which is made), RAISE (a bug), REFUSE, TOOLLESS, REPAIR (a finding that a writer without a model cannot mend),
SLOW (takes 3 s).
"""

import os
import signal
import time
from pathlib import Path
from typing import ClassVar

import numpy as np

from sgcad_core.case.records import (
    ActorInfo,
    Execution,
    Finding,
    ObservedContact,
    Query,
    RoadNetwork,
    Scenario,
    Trajectory,
)
from sgcad_core.errors import InvalidOutput, MissingTool, ProcessDied, Refused, SimulationFailed
from sgcad_core.geometry.plane import Box, contact_area, overlap
from sgcad_core.interfaces import RoadWriter, ScenarioWriter, Simulator, Tracker, Validator
from sgcad_core.records.specs import Contact

NET = """<net version="1.20">
<edge id=":m_0" function="internal">
  <lane id=":m_0_0" index="0" speed="13.9" length="0.1" shape="0,-1.6 0.1,-1.6"/></edge>
<edge id="a" from="w" to="m"><lane id="a_0" index="0" speed="13.9" length="100" shape="-100,-1.6 0,-1.6"/></edge>
<edge id="b" from="m" to="e"><lane id="b_0" index="0" speed="13.9" length="100" shape="0.1,-1.6 100,-1.6"/></edge>
<edge id="-a" from="m" to="w"><lane id="-a_0" index="0" speed="13.9" length="100" shape="0,1.6 -100,1.6"/></edge>
<junction id="w" type="dead_end" x="-100" y="0" incLanes="-a_0" intLanes="" shape="-100,0 -100,-3.2"/>
<junction id="m" type="priority" x="0" y="0" incLanes="a_0" intLanes=":m_0_0" shape="0,3.2 0,-3.2 0.1,-3.2 0.1,3.2"/>
<junction id="e" type="dead_end" x="100" y="0" incLanes="b_0" intLanes="" shape="100,0 100,-3.2"/>
<connection from="a" to="b" fromLane="0" toLane="0" via=":m_0_0" dir="s" state="M"/>
<connection from=":m_0" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
</net>
"""
XODR = '<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="7"/></OpenDRIVE>'
XOSC = '<?xml version="1.0"?><OpenSCENARIO><FileHeader revMajor="1" revMinor="2"/></OpenSCENARIO>'
CAR_M = (4.7, 1.8)


class KitRoad(RoadWriter):
    """One straight road, unless the report says otherwise."""

    asks_model: ClassVar[bool] = False

    def write(self, context, passages, findings, ask, attempt):
        text = context.narrative
        if "DIE ONCE" in text and not (mark := Path(text.split()[text.split().index("ONCE") + 1])).exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        if "DIE" in text and "DIE ONCE" not in text:
            os._exit(3)
        if "RAISE" in text:
            raise ZeroDivisionError("a bug in a plugin")
        if "TOOLLESS" in text:
            raise MissingTool("netconvert is not installed: pip install eclipse-sumo")
        if "REFUSE" in text:
            raise Refused("the report states no road", ["number of lanes"])
        if "SLOW" in text:
            time.sleep(3)
        return RoadNetwork(net_xml=NET, xodr=XODR)


class KitScenario(ScenarioWriter):
    """V2 stands at x = 30, V1 drives into its back."""

    asks_model: ClassVar[bool] = False

    def write(self, context, passages, findings, ask, attempt, network):
        infos = [
            ActorInfo(id="V1", type="car", length_m=CAR_M[0], width_m=CAR_M[1], maneuver="straight"),
            ActorInfo(id="V2", type="car", length_m=CAR_M[0], width_m=CAR_M[1], maneuver="stopped"),
        ]
        t = np.round(np.arange(0, 6, 0.05), 2)
        x1 = np.minimum(-30 + 12 * t, 26.0)
        declared = Contact(striker="V1", struck="V2", striker_area="front", struck_area="back")
        planned = (_track("V1", t, x1, np.gradient(x1, t)), _track("V2", t, np.full_like(t, 30.0), np.zeros_like(t)))
        return Scenario(xosc=XOSC, actors=tuple(infos), declared=declared, planned=planned, notes=("testkit",))


def _track(actor, t, x, v):
    return Trajectory(
        actor=actor, t_s=t, x_m=x, y_m=np.full_like(t, -1.6), heading_rad=np.zeros_like(t), speed_mps=np.maximum(v, 0.0)
    )


class KitValidator(Validator):
    """Judges roads by the word REPAIR in the report; notes otherwise."""

    stage: ClassVar[str] = "road"

    def findings(self, artifact, evidence):
        if "REPAIR" in evidence.report.narrative:
            return [Finding(source="testkit", what="a road is missing", where="road a", value="1", remedy="add one")]
        return [Finding(source="testkit", severity="note", what="nothing to say")]


class KitAskingRoad(RoadWriter):
    """One straight road once the model says "ok"; asked again until then."""

    asks_model: ClassVar[bool] = True

    def write(self, context, passages, findings, ask, attempt):
        repair = "; ".join(f.line() for f in findings)
        said = ask(context, Query(task="Draw the road.", repair=repair)).text
        if said != "ok":
            raise InvalidOutput("not ok", [Finding(source="testkit", what="the answer is not ok", value=said)])
        return RoadNetwork(net_xml=NET, xodr=XODR)


class KitSimulator(Simulator):
    """Replays the plan and looks for the first overlap of V1 and V2; `fails` where told to.

    Its process dies unless the file `died` is there, which is made then.
    """

    fails: bool = False
    died: Path | None = None

    def execute(self, scenario, network):
        if self.died and not self.died.exists():
            self.died.touch()
            raise ProcessDied("the simulator was killed", from_outside=True)
        if self.fails:
            raise SimulationFailed("the simulator died of SIGSEGV")
        one, two = scenario.planned
        for k, t in enumerate(one.t_s):
            a, b = (Box(p.x_m[k], p.y_m[k], p.heading_rad[k], *CAR_M) for p in (one, two))
            if overlap(a, b):
                areas = {"actor_area": contact_area(a, b), "other_area": contact_area(b, a)}
                contact = ObservedContact(actor="V1", other="V2", t_s=float(t), **areas)
                return Execution(simulator="testkit", trajectories=scenario.planned, contact=contact)
        raise SimulationFailed("no contact")


class KitTracker(Tracker):
    """Notes every case in a file; raises where told to."""

    file: Path
    raises: bool = False

    def log_case(self, config_name, params, case_dir, result):
        if self.raises:
            raise OSError("the tracking server is down")
        with self.file.open("a") as out:
            out.write(f"{config_name}/{case_dir.name} {result['status']}\n")
