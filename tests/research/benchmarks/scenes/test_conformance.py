"""The table of elements in the docs is what the code does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from research.benchmarks.scenes.conformance import FAMILIES, page, written_elements
from sgcad_core.errors import Unsupported
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.xml import parse_xml

DOCS = Path(__file__).resolve().parents[4] / "docs" / "conformance.md"


def test_docs_and_code_agree():
    assert DOCS.read_text(encoding="utf-8") == page(), "run `python docs/draw_conformance.py`"


def test_everything_that_we_write_we_read():
    lines = re.findall(r"^\| `(\w+)` \| (\w+) \| (\w*) \|", page(), re.MULTILINE)
    assert {tag for tag, _, written in lines if written} <= {tag for tag, reading, _ in lines if reading == "read"}
    assert {"FollowTrajectoryAction", "WorldPosition", "EnvironmentAction"} <= written_elements()


@pytest.mark.parametrize("heading", FAMILIES)
def test_what_the_table_refuses_the_player_refuses_by_name(heading):
    family, _ = FAMILIES[heading]
    refused = [tag for tag, entry in family.entries.items() if entry.status == "refused"]
    for tag in (*refused, "Unheard"):
        with pytest.raises(Unsupported, match=f"<{tag}>") as caught:
            family.compile(XmlNode(parse_xml(f"<{tag}/>", "x"), {}))
        assert caught.value.element == tag
        assert caught.value.findings[0].remedy
