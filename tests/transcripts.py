"""What models might answer a writer that takes XML and Python: good, flawed, hostile and refusing answers, by hand.

Conditional entries of the `scripted` backbone; each transcript answers both stages of any case.
"""

from __future__ import annotations

import json
import re
from typing import Any

from sgcad_core import settings

NODES = """<nodes>
  <node id="S_end" x="0" y="-120" type="dead_end"/>
  <node id="hub" x="0" y="0" type="priority"/>
  <node id="N_end" x="0" y="120" type="dead_end"/>
  <node id="E_end" x="120" y="0" type="dead_end"/>
</nodes>"""
EDGES = "<edges>{}</edges>".format("".join(
    f'<edge id="{sign}{leg}" from="{ends[0]}" to="{ends[1]}" numLanes="{lanes}" speed="15.65" spreadType="right"/>\n'
    for leg, lanes in (("S", 2), ("N", 2), ("E", 1))
    for sign, ends in (("", (f"{leg}_end", "hub")), ("-", ("hub", f"{leg}_end")))
))  # fmt: skip
EXAMPLE = re.findall(r"```python\n(.*?)```", (settings.PROMPTS / "code.md").read_text(), re.DOTALL)[0]
SCRIPT = EXAMPLE.replace("(1.6, 40.0, north), (1.6, 40.0, north)", "(1.6, -40.0, north), (1.6, -40.0, north)").replace(
    "(1.6, -65.3, north), (1.6, 35.3, north), (1.6, 37.3, north)",
    "(1.6, -110.7, north), (1.6, -44.7, north), (1.6, -43.0, north)",
)
"""The prompt's own rear-end crash, moved onto the southern leg."""
DECLARED = {
    "actors": [
        {"id": "V1", "kind": "car", "maneuver": "stopped"}, {"id": "V2", "kind": "car", "maneuver": "straight"},
    ],
    "contacts": [{"striker": "V2", "struck": "V1", "striker_area": "front", "struck_area": "back"}],
}  # fmt: skip
REFUSAL = {"refuse": "the report names no road user", "missing": ["the road users"]}


def road_answer(nodes: str = NODES, edges: str = EDGES, connections: str = "<connections/>") -> str:
    """Three fenced blocks with words around them."""
    return "Here is the network.\n" + "\n".join(f"```xml\n{text}\n```" for text in (nodes, edges, connections))


def code_answer(script: str = SCRIPT, declared: dict[str, Any] | None = None) -> str:
    """A declaration and a script, fenced."""
    shown = json.dumps(declared or DECLARED)
    return f"The declaration:\n```json\n{shown}\n```\nThe script:\n```python\n{script}```\nDone."


def _said(stage: str, *answers: str) -> list[dict[str, Any]]:
    """An answer an attempt; the last one for all further ones."""
    first = [{"stage": stage, "attempt": n, "answer": a} for n, a in enumerate(answers, 1)]
    return [*first, {"stage": stage, "answer": answers[-1]}]


GOOD = [*_said("road", road_answer()), *_said("scenario", code_answer())]
FLAWED = [
    *_said(
        "road",
        "I would draw three roads.",
        road_answer(nodes=NODES.replace("</nodes>", "")),
        road_answer(edges=EDGES.replace('numLanes="2"', 'numLanes="-2"')),
        road_answer(edges=EDGES.replace('from="E_end"', 'from="nowhere"')),
        road_answer(),
    ),
    *_said(
        "scenario",
        code_answer("from scenariogeneration import xosc\nscenario = (\n"),
        code_answer(SCRIPT.replace("import math", "import numpy as np\nimport math")),
        code_answer(SCRIPT.replace("xosc.Priority.override", "xosc.Priority.overide")),
        code_answer(SCRIPT.replace('"road.xodr"', '"town.xodr"')),
        code_answer(),
    ),
]
DOCTYPE = '<!DOCTYPE nodes [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
HOSTILE = [
    *_said(
        "road",
        json.dumps({"nodes": DOCTYPE + NODES.replace("hub", "&x;", 1), "edges": EDGES, "connections": ""}),
        road_answer(edges="<edges>" + "<edge/>" * 3000 + "</edges>"),
        json.dumps({"nodes": "<nodes>" * 2000, "edges": EDGES, "connections": ""}),
    ),
]
HOSTILE_CODE = [
    *_said("road", road_answer()),
    *_said(
        "scenario",
        code_answer("import os\nos.system('touch /tmp/out')\n" + SCRIPT),
        code_answer("while True:\n    pass\n"),
        code_answer("x = [0] * 10**11\n"),
        code_answer("().__class__.__base__.__subclasses__()\n"),
    ),
]
REFUSING = [*_said("road", road_answer()), *_said("scenario", json.dumps(REFUSAL))]
REFUSING_ROAD = _said("road", json.dumps(REFUSAL))
