"""Kinds of input, each with the readers that a batch gives it to."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from research.benchmarks.fuzz.making import answer, case_xml, changed, example, pdf, report
from sgcad_core.errors import SgcadError


@dataclass(frozen=True)
class Kind:
    """One kind of input: how it is made, and its reader."""

    name: str
    make: Callable[[random.Random], bytes]
    read: Callable[[bytes, Path], object]


def _file(name: str) -> Callable[[bytes, Path], object]:
    def read(content: bytes, place: Path) -> object:
        from plugins.report_reader.auto import Auto

        (file := place / name).write_bytes(content)
        found = Auto().read(file)
        return found.reading

    return read


def _spec(content: bytes, place: Path) -> object:
    from sgcad_core.asking.prompts import parse_answer
    from sgcad_core.records.specs import BehaviorSpec, RoadLayout, RoadSpec

    text = content.decode("utf-8", "replace")
    found = []
    for model in (RoadLayout, RoadSpec, BehaviorSpec):
        try:
            found.append(parse_answer(text, model))  # type: ignore[type-var]
        except SgcadError:
            continue
    return found


def _net(content: bytes, place: Path) -> object:
    from sgcad_core.formats.sumo.net_xml import parse_net

    return parse_net(content.decode("utf-8", "replace"))


def _xodr(content: bytes, place: Path) -> object:
    from sgcad_core.formats.opendrive.checks.road_index import lane_index
    from sgcad_core.formats.openscenario.roads.road_network import XodrRoads

    roads = XodrRoads(content.decode("utf-8", "replace"))
    return roads, lane_index(content.decode("utf-8", "replace"))


def _xosc(content: bytes, place: Path) -> object:
    from sgcad_core.formats.openscenario.check import xosc_findings
    from sgcad_core.formats.openscenario.playing.player import play

    text = content.decode("utf-8", "replace")
    xosc_findings(text, example()[2])
    return play(text, example()[2])


def _rows(content: bytes, place: Path) -> object:
    from flows.case_files import case_folder

    (file := place / "trajectories.csv").write_bytes(content)
    return case_folder.read_trajectories(file)


def _whole(content: bytes, place: Path) -> object:
    """From a report to its folder with the default config. Raises AssertionError where a bug cost the case."""
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case
    from sgcad_core import settings
    from sgcad_core.config import load

    (file := place / "r.txt").write_bytes(content)
    ending = run_case(load(settings.CONFIGS / "template.yaml", ("tracker=none",)), Case(file, "r"), place, "")
    if ending.result["status"] == "failed" and "unexpected" in ending.result["reason"]:
        raise AssertionError(ending.result["reason"])
    return ending


KINDS = {
    k.name: k
    for k in (
        Kind("text", report, _file("r.txt")),
        Kind("xml", case_xml, _file("r.xml")),
        Kind("pdf", pdf, _file("r.pdf")),
        Kind("spec", answer, _spec),
        Kind("net", lambda rng: changed(example()[1], rng), _net),
        Kind("xodr", lambda rng: changed(example()[2], rng), _xodr),
        Kind("xosc", lambda rng: changed(example()[3], rng), _xosc),
        Kind("case", report, _whole),
        Kind("player", lambda rng: changed(example()[4], rng), _rows),
    )
}
