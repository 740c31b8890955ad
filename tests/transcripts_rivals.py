"""What models might answer the writers of OmniTester and Text2Scenario: good, flawed, hostile and refusing, by hand.

Conditional entries of the `scripted` backbone; `task` tells an interpreter's question from a generator's.
"""

from __future__ import annotations

import json
from typing import Any

from tests.transcripts import DECLARED, EDGES, NODES, REFUSAL, road_answer

Entry = dict[str, Any]
SCENE = json.dumps({
    "reasoning": "A T: the road runs north and south, a side road joins from the east.",
    "roads": "A T-intersection. North and south legs with two lanes each way; an east leg with one lane each way.",
})  # fmt: skip
ROLES = json.dumps({
    "reasoning": "V1 stands northbound on edge S, V2 comes behind it.",
    "vehicles": "V1, a car, stands on edge S in lane 0. V2, a car, follows on S at 30 mph and strikes its back.",
})  # fmt: skip
_STANDS = '<stop edge="S" endPos="80" duration="60"/>'
_BLIND = 'minGap="0" tau="0.05" decel="0.5" emergencyDecel="0.5" apparentDecel="9" collisionMinGapFactor="0"'
_KEEPS = 'lcStrategic="-1" lcCooperative="0" lcSpeedGain="0" lcKeepRight="0"'
ROUTES = f"""<routes>
  <vType id="t1" vClass="passenger" length="4.7" width="1.8" sigma="0"/>
  <vType id="t2" vClass="passenger" length="4.7" width="1.8" sigma="0" {_BLIND} {_KEEPS}/>
  <vehicle id="V1" type="t1" depart="0" departLane="0" departPos="79" departSpeed="0">
    <route edges="S -N"/>{_STANDS}</vehicle>
  <vehicle id="V2" type="t2" depart="0" departLane="0" departPos="15" departSpeed="13" insertionChecks="none">
    <route edges="S -N"/></vehicle>
</routes>"""


def routes_answer(routes: str = ROUTES, declared: dict[str, Any] | None = None) -> str:
    """A declaration and a route file, fenced."""
    return f"Here it is.\n```json\n{json.dumps(declared or DECLARED)}\n```\n```xml\n{routes}\n```\n"


def _stage(stage: str, interpreter: str, thought: str, *answers: str) -> list[Entry]:
    """The interpreter's answer, then an answer an attempt; the last one for all further ones."""
    first = [{"stage": stage, "attempt": n, "answer": a} for n, a in enumerate(answers, 1)]
    return [{"stage": stage, "task": interpreter, "answer": thought}, *first, {"stage": stage, "answer": answers[-1]}]


def net(*answers: str, thought: str = SCENE) -> list[Entry]:
    """OmniTester's road stage."""
    return _stage("road", "You interpret a real crash", thought, *answers)


def vehicles(*answers: str, thought: str = ROLES) -> list[Entry]:
    """OmniTester's scenario stage."""
    return _stage("scenario", "You interpret a real crash", thought, *answers)


OMNI_GOOD = [*net(road_answer()), *vehicles(routes_answer())]
OMNI_FLAWED = [
    *net(
        "I would draw three roads.",
        road_answer(nodes=NODES.replace("</nodes>", "")),
        road_answer(edges=EDGES.replace('from="E_end"', 'from="nowhere"')),
        road_answer(),
    ),
    *vehicles(
        "V2 strikes V1.",
        routes_answer(ROUTES.replace("</routes>", "")),
        routes_answer(ROUTES.replace('tau="0.05"', 'taw="0.05"')),
        routes_answer(ROUTES.replace('edges="S -N"', 'edges="S E"', 1)),
        routes_answer(ROUTES.replace('depart="0"', 'depart="9"', 1)),
        routes_answer(),
    ),
]
_DOCTYPE = '<!DOCTYPE routes [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
OMNI_HOSTILE = [
    *net(road_answer()),
    *vehicles(
        json.dumps({**DECLARED, "routes": _DOCTYPE + ROUTES.replace("V1", "&x;", 1)}),
        routes_answer("<routes>" + "<vehicle/>" * 3000 + "</routes>"),
        routes_answer(ROUTES.replace("</routes>", '<include href="/etc/passwd"/></routes>')),
        routes_answer(ROUTES.replace('departSpeed="13"', 'departSpeed="1e308"')),
    ),
]
OMNI_REFUSING_ROAD = net("never asked", thought=json.dumps(REFUSAL))
OMNI_REFUSING = [*net(road_answer()), *vehicles("never asked", thought=json.dumps(REFUSAL))]

# ------------------------------------------------------------------ Text2Scenario
FORM: dict[str, Any] = {
    "place": "t_junction", "main_heading": "N", "main_lanes": 2, "main_one_way": False, "median": "none",
    "cross_bearing": "E", "cross_lanes": 1, "cross_one_way": False, "control": "stop",
}  # fmt: skip


def role(name: str, heading: str | None, kind: str = "car", **more: Any) -> Entry:
    """One role."""
    return {"id": name, "kind": kind, "heading": heading, "lane": None, "speed_mph": None, "comes_from": "road", **more}


def event(actor: str, action: str, target: str | None = None, *areas: str | None) -> Entry:
    """One event."""
    mine, other = areas or (None, None)
    return {"actor": actor, "action": action, "target": target, "actor_area": mine, "target_area": other}


PARSED: dict[str, Any] = {
    "roles": [role("V1", "N", lane=1), role("V2", "N", lane=1, speed_mph=30)],
    "events": [event("V1", "stopped"), event("V2", "straight"), event("V2", "strikes", "V1", "front", "back")],
    "light": "day", "weather": None, "surface": "dry",
}  # fmt: skip


def forms(*answers: Any, stage: str) -> list[Entry]:
    """Text2Scenario's answers of a stage, one an attempt."""
    first = [{"stage": stage, "attempt": n, "answer": a} for n, a in enumerate(answers, 1)]
    return [*first, {"stage": stage, "answer": answers[-1]}]


T2S_GOOD = [*forms(FORM, stage="road"), *forms(PARSED, stage="scenario")]
T2S_FLAWED = [
    *forms("A T.", {**FORM, "place": "roundabout"}, {**FORM, "main_lanes": 40}, FORM, stage="road"),
    *forms(
        "V2 struck V1.",
        {**PARSED, "events": [event("V3", "straight")]},
        {**PARSED, "events": [event("V2", "strikes", "V2")]},
        {**PARSED, "roles": [role("O1", None, "object")], "events": []},
        PARSED,
        stage="scenario",
    ),
]
T2S_HOSTILE = [
    *forms(FORM, stage="road"),
    *forms(
        '{"roles": ' * 3000,
        {**PARSED, "roles": [role("V1", "N")] * 40},
        {**PARSED, "roles": [role("V1'; DROP", "N")]},
        stage="scenario",
    ),
]
T2S_REFUSING_ROAD = forms(REFUSAL, stage="road")
T2S_REFUSING = [*forms(FORM, stage="road"), *forms(REFUSAL, stage="scenario")]
