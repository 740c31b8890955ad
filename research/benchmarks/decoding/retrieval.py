"""How good and how fast is retrieval? Prints the figures of docs/retrieval.md.

    python -m research.benchmarks.decoding.retrieval [--embedder none minilm] [--osm EXTRACT ...] [--compile 100]

60 questions (retrieval_questions.yaml) with known right chunks; 5,000 chunks indexed; junctions of the given
extracts imported, cut and compiled; 30 layouts looked up among them. No network.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median

import yaml

from plugins.retriever.knowledge.chunk import Chunk
from plugins.retriever.knowledge.junction_chunks import junction_chunks
from plugins.retriever.knowledge.sources import builtin_chunks
from plugins.retriever.lancedb import LanceDB
from sgcad_core.case.records import PlainXml
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.junction_words import describe_layout, layout_legs
from sgcad_core.roads.layout import COMPASS

QUESTIONS = Path(__file__).with_name("retrieval_questions.yaml")
MANY = 5000
LAYOUTS = 30


def quiet(count: int) -> None:
    """No bar."""


def say(what: str, figure: object) -> None:
    """One line of the table."""
    sys.stdout.write(f"{what:58s} {figure}\n")
    sys.stdout.flush()


def recall(index: LanceDB) -> None:
    """recall@5 and the time of a query."""
    questions = yaml.safe_load(QUESTIONS.read_text(encoding="utf-8"))
    index.search("warm up")
    found, times = 0, []
    for question in questions:
        started = time.perf_counter()
        hits = index.search(question["q"], 5)
        times.append(time.perf_counter() - started)
        found += bool({hit.id for hit in hits} & set(question["a"]))
    say(f"{index.embedder}: recall@5 on {len(questions)} questions", f"{found / len(questions):.3f}")
    say(f"{index.embedder}: query, median", f"{median(times) * 1000:.1f} ms")


def many() -> Iterator[Chunk]:
    """5,000 chunks: what the project brings, then copies whose names differ."""
    own = list(builtin_chunks())
    for i in range(MANY):
        chunk = own[i % len(own)]
        copy = {"id": f"{chunk.id}#{i}", "title": f"{chunk.title} {i}"}
        yield chunk if i < len(own) else chunk.model_copy(update=copy)


def indexing(index: LanceDB) -> None:
    """Seconds for 5,000 chunks."""
    started, used = time.perf_counter(), time.process_time()
    index.build(many(), quiet)
    wall, cpu = time.perf_counter() - started, time.process_time() - used
    say(f"{index.embedder}: {MANY} chunks indexed", f"{wall:.1f} s ({cpu:.1f} s of processor time)")


# ------------------------------------------------------------------ OpenStreetMap
def extracts(files: Sequence[Path], compiled: int, folder: Path) -> None:
    """Import counts, a sample compiled, nearest junctions."""
    junctions: list[Chunk] = []
    for file in files:
        skipped: list[str] = []
        started = time.perf_counter()
        found = list(junction_chunks(file, lambda name, why, skipped=skipped: skipped.append(why)))
        seconds = time.perf_counter() - started
        say(f"{file.name}: junctions imported / listed", f"{len(found)} / {len(skipped)} in {seconds:.1f} s")
        junctions += found
    sample = random.Random(1).sample(junctions, min(compiled, len(junctions)))
    good = sum(compile_network(PlainXml(**json.loads(c.data)["plain"])).xodr is not None for c in sample)
    say("cut junctions that compile to .net.xml and .xodr", f"{good} of {len(sample)}")
    nearest(junctions, folder)


def nearest(junctions: Sequence[Chunk], folder: Path) -> None:
    """30 layouts with the legs of as many kinds of junctions, turned at random: is a like one in the first five?"""
    index = LanceDB(folder=folder / "junctions")
    index.build(iter(junctions), quiet)
    kinds = {tuple(sorted(lanes(c))): c for c in junctions if len(lanes(c)) <= 8}
    draw = random.Random(2)
    chosen = draw.sample(sorted(kinds), min(LAYOUTS, len(kinds)))
    layouts = [layout_of(kind, draw) for kind in chosen]
    asks = {"words and marks": describe_layout, "words alone": lambda layout: describe_layout(layout).split("\n")[0]}
    for name, ask in asks.items():
        good = 0
        for layout in layouts:
            wanted = sorted((leg.lanes_in, leg.lanes_out) for leg in layout_legs(layout))
            hits = index.search(ask(layout), 5, ["junction"])
            good += any(sorted(lanes_of(hit.data)) == wanted for hit in hits)
        say(f"right legs and lanes in the first 5, {name}", f"{good} of {len(layouts)} layouts")
    say("kinds of junctions (legs and lanes) in the extracts", len(kinds))
    say("legs", dict(sorted(Counter(len(lanes(c)) for c in junctions).items())))


def layout_of(kind: tuple[tuple[int, int], ...], draw: random.Random) -> RoadLayout:
    """A layout of these legs in directions drawn at random."""
    bearings = draw.sample(COMPASS, len(kind))
    legs = (Leg(bearing=b, lanes_in=i, lanes_out=o) for b, (i, o) in zip(bearings, kind, strict=True))
    return RoadLayout(legs=tuple(legs))


def lanes(chunk: Chunk) -> list[tuple[int, int]]:
    """(in, out) of every leg."""
    return lanes_of(chunk.data)


def lanes_of(data: str) -> list[tuple[int, int]]:
    """The same from a hit's data."""
    return [(leg["lanes_in"], leg["lanes_out"]) for leg in json.loads(data)["legs"]]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print every figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--embedder", nargs="*", default=["none"], choices=["none", "minilm"])
    parser.add_argument("--osm", nargs="*", type=Path, default=[])
    parser.add_argument("--compile", type=int, default=100)
    parser.add_argument("--many", action="store_true", help="index 5,000 chunks as well")
    asked = parser.parse_args(arguments)
    say("cores / load", f"{os.cpu_count()} / {os.getloadavg()[0]:.1f}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for embedder in asked.embedder:
            index = LanceDB(folder=folder / embedder, embedder=embedder)
            index.build(builtin_chunks(), quiet)
            recall(index)
            if asked.many:
                indexing(LanceDB(folder=folder / f"{embedder}-many", embedder=embedder))
        if asked.osm:
            extracts(asked.osm, asked.compile, folder)


if __name__ == "__main__":
    main()
