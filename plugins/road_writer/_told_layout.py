"""What the writers that take existing roads share: the layout that the narrative states, and an index of junctions."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, cast

from sgcad_core.case.records import Context
from sgcad_core.errors import Refused
from sgcad_core.interfaces import Retriever
from sgcad_core.reading.layout.layout_facts import Defaults, layout_of_facts
from sgcad_core.records.specs import RoadLayout
from sgcad_core.registry import plugin_class

Embedder = Literal["none", "minilm", "sentence_transformers", "openai"]
MISSING = ["the road or junction of the crash", "the vehicles and how they traveled"]


def no_crash() -> Refused:
    """The refusal of a text that names neither a vehicle nor a road."""
    return Refused("the narrative names neither a vehicle nor a road", MISSING)


def told_layout(context: Context) -> RoadLayout:
    """The layout of the narrative's road facts. Raises Refused for a text without a crash."""
    facts = context.reading.roads
    if not facts.crash.vehicles and not facts.roads:
        raise no_crash()
    return layout_of_facts(facts, Defaults())


def junction_index(folder: Path, embedder: Embedder, model: str, base_url: str, junctions: int) -> Retriever:
    """A retriever of so many junctions for each description. Raises ConfigError if the folder holds no index."""
    fields = {"folder": folder, "embedder": embedder, "model": model, "base_url": base_url}
    return cast("Retriever", plugin_class("retriever", "lancedb")(**fields, kinds=("junction",), per_kind=junctions))  # type: ignore[call-arg]
