"""Background vehicles in a scenario file: valid in every version, marked, and taken out again."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.writing.background import with_background, without_background
from sgcad_core.formats.openscenario.writing.header import Source, stamped
from sgcad_core.formats.openscenario.writing.versions import VERSIONS
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import parse_xml
from tests.sgcad_core.formats.xosc_samples import actor, trajectory

K = np.arange(80)
CRASH = [trajectory("V1", K * 0.5, 0.0), trajectory("V2", 60 - K * 0.4, 3.0, np.pi)]
BEHIND = trajectory("traffic1", K * 0.45 - 20, 0.0)


def crash(version="1.2"):
    return write_xosc([actor("V1"), actor("V2")], CRASH, None, version=version)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_file_with_background_is_valid_and_moves_all_as_told(version):
    text = with_background(crash(version), [actor("traffic1")], [BEHIND])
    assert xosc_findings(text, None) == []
    played = {t.actor: t for t in play(text)}
    for wanted in (*CRASH, BEHIND):
        assert np.hypot(played[wanted.actor].x_m - wanted.x_m, played[wanted.actor].y_m - wanted.y_m).max() < 1e-3


def test_background_is_marked_and_has_a_story_of_its_own():
    root = parse_xml(with_background(crash(), [actor("traffic1")], [BEHIND]), "made")
    roles = {o.get("name"): [p.get("value") for p in o.iterfind("*/Properties/Property[@name='role']")]
             for o in root.iterfind("Entities/ScenarioObject")}  # fmt: skip
    assert roles == {"V1": [], "V2": [], "traffic1": ["traffic"]}
    assert [s.get("name") for s in root.iterfind("Storyboard/Story")] == ["crash", "traffic"]
    assert root[-1].tag == "Storyboard"
    assert root.find("Storyboard")[-1].tag == "StopTrigger"


def test_comments_before_the_root_stay():
    told = stamped(crash(), Source("c1", "V1 strikes V2", ("speed = 30",)))
    text = with_background(told, [actor("traffic1")], [BEHIND])
    assert text.startswith('<?xml version="1.0" encoding="UTF-8"?>\n<!-- Source: crash report c1: V1 strikes V2 -->')
    assert "<!-- Assumed: speed = 30 -->" in text


def test_what_was_put_in_is_taken_out_again():
    text = without_background(with_background(crash(), [actor("traffic1")], [BEHIND]))
    assert [t.actor for t in play(text)] == ["V1", "V2"]
    assert "traffic" not in text
    assert without_background(crash()) == crash()


def test_an_entity_of_the_same_name_is_a_fault():
    once = with_background(crash(), [actor("traffic1")], [BEHIND])
    with pytest.raises(InvalidOutput, match="has an entity traffic1 already: traffic needs names of its own"):
        with_background(once, [actor("traffic1")], [BEHIND])


def test_a_file_without_a_story_takes_none():
    with pytest.raises(InvalidOutput, match=r"no Entities, Storyboard/Init/Actions, Storyboard/Story: traffic cannot"):
        with_background('<OpenSCENARIO><FileHeader revMinor="2"/></OpenSCENARIO>', [actor("traffic1")], [BEHIND])
