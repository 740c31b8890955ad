"""The `reindex` deployment: builds the knowledge base again beside the old one, then replaces that in one step.

Runs that have opened the old index keep it. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from prefect import flow
from prefect.client.schemas.objects import State
from prefect.states import Completed

from flows.index_commands import DEFAULT_INDEX, SKIPPED, retriever_of


@flow(name="reindex", flow_run_name="reindex {folder}", persist_result=False)
def reindex_flow(
    folder: Path = DEFAULT_INDEX,
    files: tuple[Path, ...] = (),
    embedder: Literal["none", "minilm", "sentence_transformers", "openai"] = "none",
    model: str = "",
    base_url: str = "",
    builtin: bool = True,
) -> State[Any]:
    """Build the index of the `lancedb` retriever, as `sgcad index build` does.

    Args:
        folder: Folder of the index.
        files: OpenStreetMap extracts (.osm, .osm.gz, .osm.bz2, .osm.pbf) or .jsonl to add.
        embedder: Search by meaning beside full text; none is full text alone.
        model: Model, for sentence_transformers and openai.
        base_url: Address of an OpenAI-compatible server, for openai.
        builtin: Include the project's own documents.
    """
    retriever = retriever_of(folder, embedder=embedder, model=model, base_url=base_url)
    skipped: list[str] = []
    chunks = retriever.chunks(files, builtin, lambda name, reason: skipped.append(f"{name}: {reason}"))
    manifest = retriever.build(chunks, lambda count: None)
    if skipped:
        (folder / SKIPPED).write_text("\n".join(skipped) + "\n", encoding="utf-8")
    return Completed(message=f"{manifest.stamp}: {manifest.chunks} chunks, {len(skipped)} left out")
