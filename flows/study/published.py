"""The published figures (published.yaml): rows by name, values by measure, each with the number of its table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml

from sgcad_core.errors import ConfigError

FILE = Path(__file__).with_name("published.yaml")


@dataclass(frozen=True)
class Published:
    """One published figure, in the measure's unit (percent for shares), and its table."""

    value: float
    table: int


@dataclass(frozen=True)
class PublishedRow:
    """One published system."""

    name: str
    label: str
    figures: Mapping[str, Published]


@dataclass(frozen=True)
class Publication:
    """All transcribed figures with their source."""

    source: str
    note: str
    rows: Mapping[str, PublishedRow]

    def row(self, name: str | None) -> PublishedRow | None:
        """A row; None if none is named. Raises ConfigError naming the rows there are."""
        if name is None:
            return None
        if name not in self.rows:
            raise ConfigError(f"published: {name!r} is no row of the published figures; rows: {', '.join(self.rows)}")
        return self.rows[name]


@cache
def publication() -> Publication:
    """published.yaml as read."""
    raw = yaml.safe_load(FILE.read_text(encoding="utf-8"))
    rows = {name: PublishedRow(name, row["label"], _figures(row["figures"])) for name, row in raw["rows"].items()}
    return Publication(raw["source"], raw["note"], rows)


def _figures(tables: list[dict[str, float]]) -> dict[str, Published]:
    return {
        measure: Published(float(value), int(table["of"]))
        for table in tables
        for measure, value in table.items()
        if measure != "of"
    }
