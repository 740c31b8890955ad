"""Worked scenarios as chunks: a report's words with the layout and the behavior that say the same.

The examples stand in examples.yaml. One chunk for each stage, so that no writer reads the other's answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import yaml
from pydantic import TypeAdapter

from plugins.retriever.knowledge.chunk import Chunk
from sgcad_core.case.records import Record
from sgcad_core.records.specs import BehaviorSpec, RoadLayout

FILE = Path(__file__).with_name("examples.yaml")


class Example(Record):
    """One worked scenario."""

    name: str
    keywords: str
    excerpt: str
    layout: RoadLayout
    behavior: BehaviorSpec


def examples() -> tuple[Example, ...]:
    """All of them, checked."""
    return TypeAdapter(tuple[Example, ...]).validate_python(yaml.safe_load(FILE.read_text(encoding="utf-8")))


def example_chunks() -> Iterator[Chunk]:
    """Two chunks an example: report to layout, report to behavior."""
    for example in examples():
        title = example.name.replace("-", " ")
        layout = example.layout.model_dump_json(exclude_defaults=True)
        behavior = example.behavior.model_dump_json(exclude_defaults=True)
        report = f"A report: {example.excerpt}"
        yield Chunk(
            id=f"example/{example.name}/layout", kind="example", tasks=("road",), title=f"road layout: {title}",
            text=f"{report}\nIts layout: {layout}", keywords=example.keywords, source="sg-cadvlm",
        )  # fmt: skip
        yield Chunk(
            id=f"example/{example.name}/behavior", kind="example", tasks=("scenario",), title=f"behavior: {title}",
            text=f"{report}\nIts behavior: {behavior}", keywords=example.keywords, source="sg-cadvlm",
        )  # fmt: skip
