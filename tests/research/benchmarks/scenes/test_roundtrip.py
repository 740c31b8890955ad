"""The table of what the way back through netconvert changes."""

import pytest

from research.benchmarks.scenes.random_roads import random_layout
from research.benchmarks.scenes.reimport import differences
from research.benchmarks.scenes.roundtrip import main
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from tests.effort import spread
from tests.sgcad_core.formats.road_samples import NAMED, compiled


@pytest.mark.parametrize("name", spread(NAMED, 3))
def test_named_networks_come_back_as_they_were(name):
    network = compiled(name)
    assert differences(network.net_xml, network.xodr, "sgcad") == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_random_layouts_come_back_as_they_were(seed):
    spec = random_layout(9000 + seed)
    network = compile_network(plain_xml(spec), spec)
    assert differences(network.net_xml, network.xodr, "sgcad") == []


def test_a_lost_lane_and_a_lost_signal_are_told():
    network = compiled("signal")
    spoiled = network.xodr.replace('type="1000001"', 'type="-1"').replace('type="driving"', 'type="none"', 1)
    aspects = {d.aspect for d in differences(network.net_xml, spoiled, "netconvert")}
    assert {"signals", "lanes"} <= aspects


def test_the_command_counts_and_a_folder_without_maps_is_said(tmp_path, capsys):
    network = compiled("stop")
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "road.net.xml").write_text(network.net_xml)
    (tmp_path / "a" / "road.xodr").write_text(network.xodr)
    assert main([str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].split() == ["all", "1", "1"]
    (tmp_path / "empty").mkdir()
    assert main([str(tmp_path / "empty")]) == 2
    assert "give a folder of runs" in capsys.readouterr().err
