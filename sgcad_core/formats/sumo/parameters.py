"""Keys of the project's <param> elements of edges and nodes in plain XML and .net.xml.

A key that is missing says that nothing is known (a map, a network that a model wrote), not that there is none.
"""

from __future__ import annotations

KIND = "kind"
"""Of an edge: road, driveway, alley, ramp, circle."""
MEDIAN = "median"
"""Of an edge: none, painted, raised, grass, barrier."""
LIMIT = "speed_limit"
"""Of an edge: `POSTED` with mph where the report tells a limit, else `USUAL`: the lanes' speed is an assumption."""
POSTED, USUAL = "posted_mph ", "assumed"
AREA = "area"
"""Of an edge: rural, town, motorway, where stated."""
CENTER_LINE = "center_line"
"""Of an edge: the marking between the directions, where stated."""
GROUND = "ground"
"""Of an edge: what lies beside its pavement, each with its side ("right:curb left:ditch"), where stated."""
CONTROL = "control"
"""Of a node: what the spec says stands there (none, signal, flashing, stop, all_way_stop, yield)."""
