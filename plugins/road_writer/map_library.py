"""Existing maps only: the map of a library that is nearest to the roads of the report.

No model: rules read the roads from the narrative. Nothing is drawn for the report, so a feature that no map has is
missing from the network. Knows the narrative's road facts and the library.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from plugins.road_writer._map_search import compiled, library, nearest
from plugins.road_writer._told_layout import told_layout
from sgcad_core.case.records import Context, Finding, Passage, RoadNetwork
from sgcad_core.interfaces import Ask, RoadWriter


class MapLibrary(RoadWriter):
    """Takes the map that is nearest to the report's roads by legs, lanes, shape and control, and turns it to fit."""

    asks_model: ClassVar[bool] = False
    version: ClassVar[str] = "2"
    folder: Path | None = None
    """Folder of maps (.net.xml, .xodr); the project's own twenty if it is not set."""

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Chooses, turns and compiles a map. Raises Refused (a text without a crash), ConfigError (no maps)."""
        wanted = told_layout(context)
        return compiled(*nearest(library(self.folder), wanted))
