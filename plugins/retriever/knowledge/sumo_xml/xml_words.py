"""What SUMO's plain-XML elements and attributes mean, in our words; its schemas carry no documentation.

Data only. An element has a sentence, other words for it and an example that its schema accepts.
"""

from __future__ import annotations

from typing import NamedTuple


class Element(NamedTuple):
    """Said of one element of one file."""

    about: str
    keywords: str = ""
    example: str = ""


ELEMENTS: dict[str, Element] = {
    "nodes/nodes": Element(
        "root of the node file (.nod.xml): the junctions and dead ends of a network",
        "nod.xml input netconvert -n",
        '<nodes><node id="hub" x="0" y="0" type="traffic_light"/><node id="N_end" x="0" y="200"/></nodes>',
    ),
    "nodes/node": Element(
        "a junction or the end of a road at x, y in metres; type says how it is controlled",
        "intersection crossing place control signal stop sign yield four-way all-way",
        '<node id="hub" x="0.00" y="0.00" type="allway_stop" radius="6"/>',
    ),
    "nodes/join": Element(
        "joins several nodes that lie close together into one junction",
        "merge cluster nearby nodes divided road",
        '<join nodes="a b" type="priority"/>',
    ),
    "nodes/joinExclude": Element(
        "keeps nodes out of automatic joining", "do not merge", '<joinExclude nodes="a b"/>'
    ),
    "nodes/delete": Element("removes a node that an earlier file brought", "", '<delete id="a"/>'),
    "edges/edges": Element(
        "root of the edge file (.edg.xml): the one-way roads between nodes",
        "edg.xml input netconvert -e",
        '<edges><edge id="N" from="N_end" to="hub" numLanes="2" speed="15.6"/>'
        '<edge id="-N" from="hub" to="N_end" numLanes="2" speed="15.6"/></edges>',
    ),
    "edges/edge": Element(
        "one direction of a road from node `from` to node `to`; a two-way road needs two edges, one each way",
        "street roadway carriageway direction lanes speed limit one-way two-way",
        '<edge id="E_in" from="E_end" to="hub" numLanes="2" speed="20.12" priority="3" spreadType="right" '
        'shape="200,0 120,8 0,0"/>',
    ),
    "edges/lane": Element(
        "settings of one lane of an edge; index 0 is the rightmost lane",
        "lane width bicycle lane bus lane sidewalk who may use a lane, permissions, lane change forbidden",
        '<edge id="e" from="a" to="b" numLanes="2"><lane index="0" allow="bicycle" width="1.5"/></edge>',
    ),
    "edges/split": Element(
        "splits an edge at a distance and changes its lanes from there: turn lanes, pockets, added or ended lanes",
        "left-turn bay pocket widening lane added lane ends lane drop number of lanes changes",
        '<edge id="e" from="a" to="b" numLanes="3"><split pos="0" lanes="0 1"/><split pos="-60" lanes="0 1 2"/></edge>',
    ),
    "edges/neigh": Element(
        "names the lane of the opposite direction that may be used for overtaking",
        "opposite lane overtaking passing two-lane road",
        '<edge id="e" from="a" to="b" numLanes="1"><lane index="0"><neigh lane="-e_0"/></lane></edge>',
    ),
    "edges/stopOffset": Element(
        "puts the stop line a distance before the junction", "stop line crosswalk halt position",
        '<edge id="e" from="a" to="b"><stopOffset value="3.0"/></edge>',
    ),
    "edges/roundabout": Element(
        "declares that edges form a roundabout, so that vehicles in the circle have priority",
        "traffic circle rotary", '<roundabout nodes="a b c" edges="ab bc ca"/>',
    ),
    "connections/connections": Element(
        "root of the connection file (.con.xml): which lane leads to which behind a junction",
        "con.xml input netconvert -x",
        '<connections><connection from="S" to="-N" fromLane="0" toLane="0"/></connections>',
    ),
    "connections/connection": Element(
        "a way across a junction from a lane of one edge to a lane of another; leave connections out and "
        "netconvert guesses them",
        "turn movement left turn lane right turn only through lane allowed movement turning",
        '<connection from="S" to="-W" fromLane="1" toLane="0"/>',
    ),
    "connections/prohibition": Element(
        "says which movement has to wait for which", "right of way priority yield give way between two connections",
        '<prohibition prohibitor="S-&gt;-N" prohibited="E-&gt;-W"/>',
    ),
    "connections/crossing": Element(
        "a pedestrian crossing over edges of a node", "crosswalk zebra pedestrian walk",
        '<crossing node="hub" edges="N -N" priority="1" width="4.0"/>',
    ),
    "connections/walkingArea": Element("the place where pedestrians walk around a corner of a node", "sidewalk corner"),
    "connections/delete": Element(
        "removes a connection that netconvert would make: forbids a turn",
        "forbid a left turn, no left turn, prohibited turn, turn ban",
        '<delete from="S" to="-W"/>',
    ),
    "types/types": Element("root of the edge-type file (.typ.xml)", "typ.xml input netconvert -t"),
    "types/type": Element(
        "a named kind of edge whose lanes, speed, width and permissions edges take over by their attribute type",
        "road class template highway residential default values",
        '<types><type id="arterial" numLanes="2" speed="20.1" priority="5" width="3.5"/></types>',
    ),
    "tllogic/tlLogics": Element("root of the traffic-light file (.tll.xml)", "tll.xml input netconvert -i"),
    "tllogic/tlLogic": Element(
        "the program of a traffic light: its phases in order", "signal plan timing cycle red green yellow amber",
        '<tlLogic id="hub" type="static" programID="0" offset="0"><phase duration="30" state="GGrr"/>'
        '<phase duration="4" state="yyrr"/><phase duration="30" state="rrGG"/></tlLogic>',
    ),
    "tllogic/phase": Element(
        "one phase of a traffic light: duration in seconds and a letter for each connection: r red, y yellow, "
        "g green that yields, G green with priority, o blinking, O off",
        "signal state green time flashing", '<phase duration="4" state="yyrr"/>',
    ),
    "routes/routes": Element("root of the route file (.rou.xml): vehicle types, routes, vehicles, persons", "demand"),
    "routes/vType": Element(
        "a vehicle type: size, acceleration, speed, class and driver model; maxSpeed in m/s, sigma the driver's flaws",
        "car truck bus motorcycle dimensions braking deceleration driver behavior aggressive reckless",
        '<vType id="suv" vClass="passenger" length="4.8" width="1.9" accel="2.6" decel="4.5" maxSpeed="40"/>',
    ),
    "routes/vehicle": Element(
        "one vehicle with its departure and its route", "car departs starts insertion time speed lane position",
        '<vehicle id="V1" type="suv" depart="0.00" departLane="0" departPos="20" departSpeed="15.6">'
        '<route edges="S -N"/></vehicle>',
    ),
    "routes/trip": Element(
        "a vehicle that only names its first and last edge; the route between is computed", "from to origin",
        '<trip id="V2" depart="1.00" from="E" to="-W"/>',
    ),
    "routes/flow": Element(
        "many equal vehicles over a time", "traffic volume vehicles per hour background traffic",
        '<flow id="f" begin="0" end="60" vehsPerHour="600" from="S" to="-N"/>',
    ),
    "routes/route": Element("a list of edges that follow each other", "path course", '<route id="r" edges="S -N"/>'),
    "routes/stop": Element(
        "makes a vehicle halt on a lane for a duration or until a time",
        "parked car standing vehicle waiting parking stopped in lane",
        '<stop lane="S_0" endPos="80" duration="20" parking="false"/>',
    ),
    "routes/person": Element(
        "a pedestrian or passenger with a plan of walks and rides", "walker on foot crossing the street",
        '<person id="P1" depart="0"><walk from="N" to="-E"/></person>',
    ),
    "routes/walk": Element("a person's way on foot along edges", "pedestrian speed", '<walk from="N" to="-E"/>'),
    "additional/additional": Element("root of the file of additional objects (.add.xml)", "add.xml"),
    "additional/poly": Element("a polygon drawn on the map, such as a building", "background shape house sight"),
    "additional/poi": Element("a point of interest on the map, such as a pole or tree", "fixed object landmark"),
    "additional/variableSpeedSign": Element("changes the speed limit of lanes at given times", "speed limit change"),
    "additional/parkingArea": Element("a stretch of lane with parking spaces", "parked vehicles roadside lot"),
    "additional/busStop": Element("a place on a lane where buses stop", "public transport"),
}  # fmt: skip

ATTRIBUTES: dict[str, str] = {
    "id": "name by which other elements refer to it; unique in its file",
    "x": "metres east", "y": "metres north", "z": "height in metres",
    "nodes/node@type": "control of the junction: priority (minor roads yield), priority_stop (minor roads have stop "
    "signs), allway_stop, traffic_light, right_before_left, unregulated, zipper (lanes merge in turn), dead_end",
    "nodes/node@tl": "id of the traffic light that controls it; nodes with one id share a light",
    "nodes/node@tlType": "static (fixed times) or actuated (detectors lengthen green)",
    "nodes/node@radius": "turning radius of the corners in metres; larger for trucks and wide junctions",
    "nodes/node@rightOfWay": "how right of way is computed where edge priorities are equal",
    "nodes/node@fringe": "outer: the road leads out of the map here",
    "nodes/node@keepClear": "false: vehicles may block the junction when traffic backs up",
    "nodes/node@roundabout": "the node is part of a roundabout",
    "from": "node (of an edge) or edge (of a connection, trip, walk) where it starts",
    "to": "node (of an edge) or edge (of a connection, trip, walk) where it ends",
    "numLanes": "number of lanes: how many lanes the edge has in its direction, at least 1; default 1",
    "speed": "speed limit of the road or lane in m/s: mph times 0.44704 (35 mph = 15.65, 65 mph = 29.06)",
    "priority": "rank of the road: at a junction the edge of higher priority is the main road, the others give way",
    "spreadType": "where lanes lie relative to the line: right (beside it, for two-way roads), center (one-way "
    "roads), roadCenter (both directions share the middle)",
    "shape": "points \"x,y x,y\" of the line in metres: how a curved or bent road runs",
    "width": "width in metres; a lane's default is 3.2", "length": "length in metres; default measured from the shape",
    "endOffset": "moves the stop line back from the junction by so many metres",
    "allow": "vehicle classes that may use it, all others may not: passenger, truck, bus, bicycle, pedestrian, ...",
    "disallow": "vehicle classes that may not use it",
    "sidewalkWidth": "adds a sidewalk of this width in metres", "bikeLaneWidth": "adds a bicycle lane of this width",
    "edges/lane@index": "which lane: 0 is the rightmost, counting to the left",
    "edges/lane@acceleration": "true: an acceleration lane of an on-ramp, where merging is expected",
    "changeLeft": "vehicle classes that may change to the lane on the left; empty for nobody (solid line)",
    "changeRight": "vehicle classes that may change to the lane on the right; empty for nobody (solid line)",
    "friction": "friction of the surface: 1 is dry, about 0.7 wet, about 0.3 snow or ice",
    "edges/split@pos": "distance in metres from the start of the edge, negative from its end",
    "edges/split@lanes": "indices of the lanes that exist behind the split",
    "fromLane": "index of the lane before the junction, 0 is the rightmost",
    "toLane": "index of the lane behind the junction, 0 is the rightmost",
    "connections/connection@pass": "true: vehicles on it need not give way to anyone",
    "connections/connection@uncontrolled": "true: the connection is not under the traffic light",
    "connections/connection@contPos": "how far into the junction a turning vehicle waits, metres",
    "connections/connection@indirect": "an indirect left turn, as bicycles make it in two steps",
    "connections/connection@visibility": "distance in metres from which crossing traffic can be seen",
    "connections/prohibition@prohibitor": "the movement that has right of way, written from->to",
    "connections/prohibition@prohibited": "the movement that must wait, written from->to",
    "vClass": "vehicle class: passenger, truck, trailer, bus, motorcycle, bicycle, pedestrian, emergency, ...",
    "routes/vType@length": "length of the vehicle in metres", "routes/vType@width": "width of the vehicle in metres",
    "accel": "greatest acceleration in m/s²", "decel": "usual braking deceleration in m/s²",
    "emergencyDecel": "hardest braking possible in m/s²", "maxSpeed": "greatest speed in m/s",
    "minGap": "gap to the vehicle in front when standing, metres", "tau": "time gap that the driver keeps, seconds",
    "sigma": "imperfection of the driver, 0 none to 1", "speedFactor": "multiplies the limit: 1.2 drives 20 % over it",
    "carFollowModel": "driver model for following: Krauss, IDM, EIDM, ACC, Wiedemann, ...",
    "laneChangeModel": "driver model for changing lanes: LC2013, SL2015, DK2008",
    "jmIgnoreFoeProb": "probability to ignore vehicles that have right of way at a junction: failing to yield",
    "jmIgnoreFoeSpeed": "only foes slower than this speed are ignored, m/s",
    "jmDriveAfterRedTime": "seconds after red began in which the driver still enters: running the red light",
    "jmDriveAfterYellowTime": "seconds after yellow began in which the driver still enters",
    "impatience": "how willing a driver is to force others to brake, 0 to 1",
    "guiShape": "how the vehicle is drawn", "depart": "time of departure in seconds",
    "departLane": "lane index at departure, or best, free, random, first",
    "departPos": "place on the first edge in metres, or base, free, last, random",
    "departSpeed": "speed at departure in m/s, or max, desired, speedLimit, random",
    "arrivalLane": "lane index at the end", "arrivalPos": "place on the last edge in metres",
    "edges": "ids of edges, separated by blanks", "vehsPerHour": "vehicles an hour",
    "duration": "seconds", "state": "a letter for each connection: r y g G o O", "offset": "shift in seconds",
    "parking": "true: the vehicle stands beside the lane and does not block it", "until": "waits till this time, s",
    "programID": "name of the program; a light may have several", "endPos": "end on the lane, metres",
    "oneway": "true: one direction only",
}  # fmt: skip
