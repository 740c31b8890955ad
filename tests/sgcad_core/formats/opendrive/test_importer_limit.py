"""Why `research.benchmarks.scenes.roundtrip` finds connections that netconvert does not give back: a limit of its
importer.

Two lanes of one road lead into the one lane of another, linked in every way that OpenDRIVE has. netconvert makes one
connection of each, and says nothing.
"""

import subprocess
from pathlib import Path

import pytest

from sgcad_core import settings
from sgcad_core.formats.sumo.net_xml import parse_net

HEADER = (
    '<OpenDRIVE><header revMajor="1" revMinor="7" name="" version="1.00" north="9" south="-9" east="120" west="0"/>'
)
TO_JUNCTION = '<successor elementType="junction" elementId="1"/>'
FROM_JUNCTION = '<predecessor elementType="junction" elementId="1"/>'
ACROSS = (
    '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    '<successor elementType="road" elementId="2" contactPoint="start"/>'
)


def lane(number: int, before: int | None = None, behind: int | None = None) -> str:
    links = "".join(
        f'<{side} id="{other}"/>'
        for side, other in (("predecessor", before), ("successor", behind))
        if other is not None
    )
    width = '<width sOffset="0" a="3.6" b="0" c="0" d="0"/>'
    return f'<lane id="{number}" type="driving" level="false"><link>{links}</link>{width}</lane>'


def road(name: int, x: int, length: int, lanes: str, link: str = "", junction: str = "-1") -> str:
    center = '<center><lane id="0" type="none" level="false"/></center>'
    line = f'<geometry s="0" x="{x}" y="0" hdg="0" length="{length}"><line/></geometry>'
    return (
        f'<road name="" length="{length}" id="{name}" junction="{junction}"><link>{link}</link>'
        f"<planView>{line}</planView>"
        f'<lanes><laneSection s="0">{center}<right>{lanes}</right></laneSection></lanes></road>'
    )


def junction(*connections: tuple[int, tuple[tuple[int, int], ...]]) -> str:
    made = (
        f'<connection id="{i}" incomingRoad="1" connectingRoad="{by}" contactPoint="start">'
        + "".join(f'<laneLink from="{a}" to="{b}"/>' for a, b in links) + "</connection>"
        for i, (by, links) in enumerate(connections)
    )  # fmt: skip
    return f'<junction id="1" name="">{"".join(made)}</junction>'


ENDS = road(1, 0, 50, lane(-1) + lane(-2), TO_JUNCTION) + road(2, 60, 50, lane(-1), FROM_JUNCTION)
WAYS = {
    "a connecting road for each": ENDS
    + road(3, 50, 10, lane(-1, -1, -1), ACROSS, "1") + road(4, 50, 10, lane(-1, -2, -1), ACROSS, "1")
    + junction((3, ((-1, -1),)), (4, ((-2, -1),))),
    "one connecting road of two lanes": ENDS
    + road(3, 50, 10, lane(-1, -1, -1) + lane(-2, -2, -1), ACROSS, "1") + junction((3, ((-1, -1), (-2, -2)))),
    "one connecting lane for both": ENDS
    + road(3, 50, 10, lane(-1, -1, -1), ACROSS, "1") + junction((3, ((-1, -1), (-2, -1)))),
    "no junction": road(1, 0, 60, lane(-1, None, -1) + lane(-2, None, -1), ACROSS.split("/>")[1] + "/>")
    + road(2, 60, 50, lane(-1, -1), ACROSS.split("/>")[0] + "/>"),
}  # fmt: skip


@pytest.mark.parametrize("way", WAYS)
def test_netconvert_takes_one_of_two_lanes_that_lead_into_one_however_they_are_linked(way: str, tmp_path: Path) -> None:
    (tmp_path / "m.xodr").write_text(f'<?xml version="1.0"?>{HEADER}{WAYS[way]}</OpenDRIVE>')
    command = [str(settings.netconvert()), "--opendrive-files", "m.xodr", "-o", "m.net.xml", "--no-turnarounds"]
    done = subprocess.run(command, cwd=tmp_path, env=settings.subprocess_environment(), capture_output=True, check=True)
    assert b"arning" not in done.stderr
    links = parse_net((tmp_path / "m.net.xml").read_text()).connections
    assert [(link.from_edge, link.to_edge) for link in links] == [("-1", "-2")]
