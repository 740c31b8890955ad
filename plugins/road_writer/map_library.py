"""Existing maps only: the map of a library that is most like what the report tells of its roads.

No model: the roads are read off the narrative by rules. Nothing is drawn for the report, so what a map lacks stays
lacking. Knows the narrative's road facts and the library.
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
    """The nearest map by legs, lanes, shape and control, turned so that its legs lie as told."""

    asks_model: ClassVar[bool] = False
    version: ClassVar[str] = "2"
    folder: Path | None = None
    """Maps of your own (.net.xml, .xodr); the project's twenty where none is named."""

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Choose, turn, compile. Raises Refused on a text without a crash, ConfigError for a folder without maps."""
        wanted = told_layout(context)
        return compiled(*nearest(library(self.folder), wanted))
