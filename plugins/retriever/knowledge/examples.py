"""Worked scenarios and code snippets as chunks, read from examples.yaml and snippets.yaml.

An example pairs the words of a report with the layout and the behavior that say the same. It becomes one chunk for each
stage, so that no writer reads the answer of the other stage. Knows no database.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter

from plugins.retriever.knowledge.chunk import Chunk
from sgcad_core.case.records import Record
from sgcad_core.records.specs import BehaviorSpec, RoadLayout

SNIPPET_MODULES = {"scenario": "xosc", "road": "xodr"}
"""The module of scenariogeneration that the snippets of a stage use."""


class Example(Record):
    """One worked scenario."""

    name: str
    keywords: str
    excerpt: str
    layout: RoadLayout
    behavior: BehaviorSpec


def examples() -> tuple[Example, ...]:
    """All worked scenarios, validated."""
    return TypeAdapter(tuple[Example, ...]).validate_python(_content("examples.yaml"))


def example_chunks() -> Iterator[Chunk]:
    """Two chunks for each example: report to layout, report to behavior."""
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


def snippet_chunks() -> Iterator[Chunk]:
    """One chunk for each snippet: its title, the import and the code."""
    for name, entry in _content("snippets.yaml").items():
        title, task = entry["title"], entry["task"]
        text = f"# {title}\nfrom scenariogeneration import {SNIPPET_MODULES[task]}\n\n{entry['code']}"
        yield Chunk(
            id=f"snippet/{name}", kind="snippet", tasks=(task,), title=title, text=text, keywords=entry["keywords"],
            source="sg-cadvlm",
        )  # fmt: skip


def _content(file: str) -> Any:
    return yaml.safe_load(Path(__file__).with_name(file).read_text(encoding="utf-8"))
