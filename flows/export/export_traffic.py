"""`sgcad export --traffic`: a finished case's files anew, with traffic around its crash."""

from __future__ import annotations

import json
from pathlib import Path
from typing import cast

from flows.export.ego_files import write_ego_files
from flows.export.finished_case import FinishedCase
from flows.export.formats import Wish
from flows.export.traffic_files import traffic_around_script, write_motion
from flows.player.player_page import page_among
from sgcad_core.case.density import Density
from sgcad_core.case.traffic import Traffic
from sgcad_core.errors import BadInput
from sgcad_core.interfaces import Simulator
from sgcad_core.registry import plugin_class

SIMULATOR = "libsumo"


def export_traffic(case: FinishedCase, place: Path, wish: Wish, density: Density, seed: int) -> list[Path]:
    """A finished case with traffic: its files anew in a folder named after the density; the case's own stay.

    Raises NoTraffic, SimulationFailed, InvalidOutput, ConfigError.
    """
    simulator = cast("Simulator", plugin_class("simulator", SIMULATOR)())
    made = traffic_around_script(case.script, case.xodr, density, seed, simulator)
    folder = place / density
    folder.mkdir(parents=True, exist_ok=True)
    texts = {"road.xodr": case.xodr, "road.net.xml": case.script.net_xml, "scenario.xosc": made.xosc or ""}
    texts["traffic.json"] = json.dumps(made.traffic.summary(), indent=1) + "\n"
    if page := _page(case, made.traffic):
        texts["player.html"] = page
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    written = [folder / name for name in texts] + write_motion(folder, case.script, made.traffic)
    about = case.source, case.behavior, case.xodr, wish.version, made.traffic.background
    return written + write_ego_files(folder, case.script, case.ego(wish.ego), *about)


def _page(case: FinishedCase, traffic: Traffic) -> str | None:
    """The case's player with the traffic; None where it has none."""
    file = case.folder / "player.html"
    try:
        return page_among(file.read_text(encoding="utf-8"), traffic.background)
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as fault:
        raise BadInput(f"{file}: cannot be read ({fault}); run the case again") from fault
