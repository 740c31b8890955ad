"""Maps of tiny roads with hundreds of ways on: which is straightest is looked for once."""

from research.benchmarks.attack.scenario_words import geometry, network, road
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace

COUNT, LENGTH_M = 150, 0.001


def ring():
    """A road that leads into a junction of COUNT roads, all of which lead back onto it."""
    line = geometry(0, 0, LENGTH_M)
    into = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    back = '<successor elementType="road" elementId="1" contactPoint="start"/>'
    inner = [road(k, line, LENGTH_M, link=into + back, junction="j") for k in range(2, COUNT + 2)]
    connections = [
        f'<connection id="{k}" incomingRoad="1" connectingRoad="{k}" contactPoint="start"><laneLink from="-1" to="-1"/>'
        "</connection>"
        for k in range(2, COUNT + 2)
    ]
    first = road(1, line, LENGTH_M, link='<successor elementType="junction" elementId="j"/>')
    return network("".join([first, f'<junction id="j">{"".join(connections)}</junction>', *inner]))


def test_a_second_drive_over_the_same_roads_looks_at_no_choice_again():
    roads, place = XodrRoads(ring()), LanePlace("1", -1, 0.0, 0.0)
    first = roads.drive(place, 1)
    spent = roads.budget.counts["points looked at"]
    again = roads.drive(place, 1)
    assert (again.points == first.points).all()
    more = roads.budget.counts["points looked at"] - spent
    assert spent - more == 150 * (
        COUNT + 1
    )  # of each of the two kinds of place once: the junction's ways, the way back
    assert more < spent
