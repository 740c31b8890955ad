"""Retrieval from a knowledge base in one folder: API passages, SUMO's XML, worked scenarios, real junctions.

`sgcad index build` makes the folder. Knows neither prompts nor writers.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, cast

from pydantic import Field, PrivateAttr

from plugins.retriever.knowledge.chunk import KINDS, TASKS, Chunk, Kind, Task
from plugins.retriever.knowledge.embedders import Embedder, Name, make
from plugins.retriever.knowledge.manifest import Manifest, read_manifest
from sgcad_core.case.records import Passage
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Retriever

if TYPE_CHECKING:
    from plugins.retriever.knowledge.search import Hit, Index
    from plugins.retriever.knowledge.sources import OnSkip
    from plugins.retriever.knowledge.store import Progress

TOPICS: dict[tuple[Kind, Task], tuple[str, ...]] = {
    ("xml", "road"): (
        "edge of a road: numLanes, speed, priority, shape, from node, to node",
        "node of a junction: x, y, type priority traffic_light priority_stop",
        "connection from edge to edge, fromLane, toLane",
    ),
    ("xml", "scenario"): (
        "vehicle with depart, departLane, departPos, departSpeed and route",
        "vType length width minGap tau decel junction model ignore foe",
        "route edges",
    ),
    ("api", "scenario"): (
        "xosc.FollowTrajectoryAction with a trajectory",
        "xosc.Trajectory and xosc.Polyline with times and positions",
        "xosc.Vehicle name vehicle_type boundingbox frontaxle rearaxle",
        "xosc.TeleportAction in Init",
        "xosc.StoryBoard, Story, Act, ManeuverGroup, Event with a trigger",
    ),
    ("snippet", "scenario"): ("drive along a timed trajectory of world positions", "a whole scenario of two vehicles"),
}
"""Queries beside the narrative, most needed first. A writer of XML or Python needs these pieces for every crash, but a
narrative says "vehicle" and "lane" in every sentence and never "trajectory" or "connection"."""


class LanceDB(Retriever):
    """Finds passages by full text and, with an embedder, by meaning, in an index that `sgcad index build` makes."""

    folder: Path = Path("knowledge")
    """Where the index lies; relative to the working directory."""
    embedder: Name = "none"
    """none: full text alone. minilm: offline, an optional package. sentence_transformers, openai: see model."""
    model: str = ""
    """Hub id or folder (sentence_transformers), or the server's model (openai; text-embedding-ada-002 if empty)."""
    base_url: str = ""
    """Of an OpenAI-compatible server, such as http://127.0.0.1:8000/v1."""
    api_key_env: str = "OPENAI_API_KEY"
    """Name of the variable that holds the server's key."""
    kinds: tuple[Kind, ...] = ("example", "junction")
    """What is retrieved; api, snippet and xml serve writers that write code or XML themselves."""
    road_kinds: tuple[Kind, ...] | None = None
    """What the road stage retrieves instead, such as xml for a writer of SUMO XML."""
    scenario_kinds: tuple[Kind, ...] | None = None
    """What the scenario stage retrieves instead, such as api and snippet for a writer of Python."""
    per_kind: int = Field(2, ge=1, le=20)
    """Passages of each kind."""
    _guard: threading.Lock = PrivateAttr(default_factory=threading.Lock)

    def retrieve(self, text: str, task: str) -> tuple[Passage, ...]:
        """The best passages of each kind, kinds in the field's order. Raises ConfigError if there is no index."""
        if task not in TASKS:
            raise ConfigError(f"retriever 'lancedb' serves the tasks {', '.join(TASKS)}, not {task!r}")
        own = self.road_kinds if task == "road" else self.scenario_kinds
        kinds = self.kinds if own is None else own
        found = [hit for kind in kinds for hit in self._of_kind(text, kind, task)]
        return tuple(Passage(id=hit.id, kind=hit.kind, text=hit.text, score=hit.score, data=hit.data) for hit in found)

    def _of_kind(self, text: str, kind: Kind, task: Task) -> list[Hit]:
        """The best of one kind, taken in turn from the hits of the task's topics and of the text."""
        asked = (*TOPICS.get((kind, task), ()), text)
        lists = [self.search(words, self.per_kind, (kind,), task) for words in asked]
        in_turn = (hit for rank in zip_longest(*lists) for hit in rank if hit is not None)
        return list({hit.id: hit for hit in in_turn}.values())[: self.per_kind]

    def search(self, text: str, k: int = 5, kinds: Sequence[Kind] = (), task: Task | None = None) -> list[Hit]:
        """The k best chunks of any of the kinds (all if none is named), best first."""
        return self._index().search(text, k, kinds, task)

    def search_checked(self, text: str, k: int, kinds: Sequence[str], task: str | None) -> list[Hit]:
        """`search` with names from a command line. Raises ConfigError that lists the known names."""
        for name, known in [*((kind, KINDS) for kind in kinds), *([(task, TASKS)] if task else [])]:
            if name not in known:
                raise ConfigError(f"unknown {name!r}; there are {', '.join(known)}")
        return self.search(text, k, cast("Sequence[Kind]", kinds), cast("Task | None", task))

    @property
    def stamp(self) -> str:
        """Version and fingerprint of the knowledge, for logs: "kb-v1-0123456789ab". Raises ConfigError."""
        return self.stats().stamp

    def stats(self) -> Manifest:
        """What the index holds. Raises ConfigError."""
        return read_manifest(self.folder)

    def chunks(self, files: Sequence[Path], builtin: bool, on_skip: OnSkip) -> Iterator[Chunk]:
        """The project's own chunks, if wanted, then each file's. Raises ConfigError before anything is read."""
        from plugins.retriever.knowledge import sources

        for file in files:
            sources.check_file(file)
        own = sources.builtin_chunks() if builtin else iter(())
        return chain(own, chain.from_iterable(sources.file_chunks(file, on_skip) for file in files))

    def build(self, chunks: Iterable[Chunk], progress: Progress) -> Manifest:
        """Writes a new index from chunks. Raises ConfigError, MissingTool."""
        from plugins.retriever.knowledge import store

        return store.build(self.folder, chunks, self._embedder, progress)

    def add(self, chunks: Iterable[Chunk], progress: Progress) -> Manifest:
        """Adds new and changed chunks. Raises ConfigError, MissingTool."""
        from plugins.retriever.knowledge import store

        return store.add(self.folder, chunks, self._embedder, progress)

    def _index(self) -> Index:
        with self._guard:
            return self._opened

    @cached_property
    def _opened(self) -> Index:
        from plugins.retriever.knowledge.search import Index

        read_manifest(self.folder)  # before a model is loaded
        return Index(self.folder, self._embedder)

    @cached_property
    def _embedder(self) -> Embedder | None:
        return make(self.embedder, self.model, self.base_url, self.api_key_env)
