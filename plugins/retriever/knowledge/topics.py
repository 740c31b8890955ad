"""What a writer of XML or Python needs whatever the crash: asked of the index beside the narrative's own words.

A narrative says "vehicle" and "lane" in every sentence and never "trajectory" or "connection", so alone it finds the
wrong pieces of a language. Knows no database.
"""

from __future__ import annotations

from plugins.retriever.knowledge.chunk import Kind, Task

_XML_ROAD = (
    "edge of a road: numLanes, speed, priority, shape, from node, to node",
    "node of a junction: x, y, type priority traffic_light priority_stop",
    "connection from edge to edge, fromLane, toLane",
)
_XML_SCENARIO = (
    "vehicle with depart, departLane, departPos, departSpeed and route",
    "vType length width minGap tau decel junction model ignore foe",
    "route edges",
)
_API_SCENARIO = (
    "xosc.FollowTrajectoryAction with a trajectory",
    "xosc.Trajectory and xosc.Polyline with times and positions",
    "xosc.Vehicle name vehicle_type boundingbox frontaxle rearaxle",
    "xosc.TeleportAction in Init",
    "xosc.StoryBoard, Story, Act, ManeuverGroup, Event with a trigger",
)
_SNIPPET_SCENARIO = ("drive along a timed trajectory of world positions", "a whole scenario of two vehicles")
_TOPICS: dict[tuple[Kind, Task], tuple[str, ...]] = {
    ("xml", "road"): _XML_ROAD,
    ("xml", "scenario"): _XML_SCENARIO,
    ("api", "scenario"): _API_SCENARIO,
    ("snippet", "scenario"): _SNIPPET_SCENARIO,
}


def topics(kind: Kind, task: Task) -> tuple[str, ...]:
    """Questions to ask for pieces of that kind, the most needed first; none where the narrative is the question."""
    return _TOPICS.get((kind, task), ())
