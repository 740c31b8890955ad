"""`sgcad index build | add | search | stats`: the knowledge base of the `lancedb` retriever.

Progress goes to stderr, answers to stdout.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from flows.terminal import escape_plain

DEFAULT_INDEX = Path("knowledge")
SKIPPED = "skipped.txt"

index_app = typer.Typer(no_args_is_help=True, help="The knowledge base: `build`, `add`, `search`, `stats`.")

Files = Annotated[list[Path] | None, typer.Argument(help="OpenStreetMap extracts (.osm, .osm.gz|bz2|pbf) or .jsonl.")]
Folder = Annotated[Path, typer.Option("--out", "-o", help="Folder of the index.")]
Embedder = Annotated[
    str, typer.Option("--embedder", "-e", help="none (full text), minilm, sentence_transformers or openai.")
]
Model = Annotated[str, typer.Option("--model", help="Model, for sentence_transformers and openai.")]
BaseUrl = Annotated[str, typer.Option("--base-url", help="Address of an OpenAI-compatible server.")]


@index_app.command()
def build(
    files: Files = None,
    out: Folder = DEFAULT_INDEX,
    embedder: Embedder = "none",
    model: Model = "",
    base_url: BaseUrl = "",
    builtin: Annotated[bool, typer.Option(help="Include the project's own documents.")] = True,
) -> None:
    """Build the index from the project's own documents and the files; an existing index is replaced."""
    retriever = retriever_of(out, embedder=embedder, model=model, base_url=base_url)
    skipped: list[str] = []
    chunks = retriever.chunks(files or [], builtin, _note(skipped))
    with _bar("indexing") as progress:
        manifest = retriever.build(chunks, progress)
    _describe_with_skipped(out, manifest, skipped)


@index_app.command()
def add(files: Files = None, out: Folder = DEFAULT_INDEX, base_url: BaseUrl = "") -> None:
    """Add files to the index, or without files the project's new documents; existing entries stay."""
    before = retriever_of(out).stats()
    kind, _, model = before.embedder.partition("/")
    named = {"embedder": kind or "none", "model": "" if kind == "minilm" else model, "base_url": base_url}
    retriever = retriever_of(out, **named)
    skipped: list[str] = []
    chunks = retriever.chunks(files or [], not files, _note(skipped))
    with _bar("adding") as progress:
        manifest = retriever.add(chunks, progress)
    if manifest == before:
        typer.echo("nothing new")
    _describe_with_skipped(out, manifest, skipped)


@index_app.command()
def search(
    text: Annotated[str, typer.Argument(help="Text to search for.")],
    out: Folder = DEFAULT_INDEX,
    kind: Annotated[list[str] | None, typer.Option("--kind", help="api, snippet, xml, example, junction.")] = None,
    task: Annotated[str | None, typer.Option("--task", help="road or scenario.")] = None,
    count: Annotated[int, typer.Option("-k", min=1, max=100, help="Number of passages.")] = 5,
    embedder: Embedder = "",
    base_url: BaseUrl = "",
) -> None:
    """Show the passages nearest to a text, best first."""
    manifest = retriever_of(out).stats()
    known, _, model = manifest.embedder.partition("/")
    named = {"embedder": embedder or known or "none", "model": "" if known == "minilm" else model}
    retriever = retriever_of(out, base_url=base_url, **named)
    hits = retriever.search_checked(text, count, kind or [], task)
    for number, hit in enumerate(hits, 1):
        typer.echo(escape_plain(f"{number}. [{hit.kind}] {hit.id}  {hit.score:.4f}\n{hit.text}\n"))
    if not hits:
        typer.echo(f"nothing found{_why_nothing(kind or (), manifest.kinds)}")


def _why_nothing(wanted: Sequence[str], there: Mapping[str, int]) -> str:
    """What to do where the index has nothing of the kinds that were asked for; "" where it has."""
    if not wanted or any(there.get(kind) for kind in wanted):
        return ""
    remedy = "; add an OpenStreetMap extract: sgcad index add FILE" if "junction" in wanted else ""
    return f": the index has no {' or '.join(wanted)}, only {', '.join(there)}{remedy}"


@index_app.command()
def stats(out: Folder = DEFAULT_INDEX) -> None:
    """Print the index's version, embedder and numbers of entries."""
    _describe(out, retriever_of(out).stats())


def retriever_of(folder: Path, **fields: str) -> Any:
    """The retriever for a folder. Raises ConfigError for a field that is wrong."""
    from pydantic import ValidationError

    from sgcad_core.errors import ConfigError
    from sgcad_core.registry import plugin_class

    try:
        return plugin_class("retriever", "lancedb")(folder=folder, **fields)  # type: ignore[call-arg]
    except ValidationError as fault:
        faults = (f"--{e['loc'][0]} {e['input']!r}: {e['msg']}" for e in fault.errors(include_url=False))
        raise ConfigError("; ".join(faults)) from fault


def _note(skipped: list[str]) -> Callable[[str, str], None]:
    return lambda name, reason: skipped.append(f"{name}: {reason}")


@contextmanager
def _bar(word: str) -> Iterator[Callable[[int], None]]:
    """A bar on stderr that counts chunks; their total is not known in advance."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn(word), BarColumn(), TextColumn("{task.completed:.0f} chunks"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True, emoji=False), transient=True) as progress:
        task = progress.add_task(word, total=None)
        yield lambda count: progress.advance(task, count)


def _describe_with_skipped(folder: Path, manifest: Any, skipped: list[str]) -> None:
    _describe(folder, manifest)
    if skipped:
        (folder / SKIPPED).write_text("\n".join(skipped) + "\n", encoding="utf-8")
        typer.echo(f"left out   {len(skipped)}, each with its reason in {folder / SKIPPED}")


def _describe(folder: Path, manifest: Any) -> None:
    kinds = ", ".join(f"{count} {kind}" for kind, count in manifest.kinds.items())
    typer.echo(f"index      {folder}\nversion    {manifest.stamp}")
    typer.echo(f"embedder   {manifest.embedder or 'none (full text)'}")
    typer.echo(f"chunks     {manifest.chunks}: {kinds}\nwritten    {manifest.written}")
    for source, count in manifest.sources.items():
        typer.echo(f"source     {source or 'unnamed'}: {count}")
