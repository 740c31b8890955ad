"""Networks, maps, scenarios, frames of drivers and scripts made to do harm: the first of each end as they should."""

from __future__ import annotations

import random
from contextlib import suppress
from itertools import islice

import pytest

from research.benchmarks.attack import driver_frames, net, scripts, xodr, xosc
from sgcad_core.errors import SgcadError

KINDS = (net, xodr, xosc, driver_frames, scripts)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.NAME)
def test_a_seed_makes_the_same_inputs(kind, tmp_path):
    made = []
    for k in range(2):
        (place := tmp_path / str(k)).mkdir()
        items = list(islice(kind.inputs(random.Random("1"), place), 6))
        files = [sorted((f.name, f.read_bytes()) for f in place.rglob("*") if f.is_file())]
        made.append([str(item).replace(str(place), "") for item in items] + files)
    assert made[0] == made[1]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.NAME)
def test_the_first_inputs_end_as_a_result_or_a_refusal(kind, tmp_path):
    done = 0
    for item in islice(kind.inputs(random.Random("2"), tmp_path), 12):
        with suppress(SgcadError):
            kind.feed(item)
            done += 1
    assert done, "none is played"


def test_a_script_that_gets_hold_of_something_is_seen(monkeypatch):
    from plugins.scenario_writer.sandbox import script_runner

    ran = script_runner.Ran(printed="got <frame object at 0x1>")
    monkeypatch.setattr(script_runner, "run_script", lambda *_: ran)
    with pytest.raises(AssertionError, match="<frame object"):
        scripts.feed(f"{scripts._HEAD}found = 1")


def test_a_leap_that_is_credited_is_seen(monkeypatch):
    from sgcad_core.handover.reach import Reach

    monkeypatch.setattr(Reach, "check", lambda *_: None)
    with pytest.raises(AssertionError, match="within a step"):
        driver_frames.feed(b'{"trajectory": [[0.05, 500, 300, 0, 15]]}\n')
