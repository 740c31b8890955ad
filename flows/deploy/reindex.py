"""The `reindex` deployment: builds the knowledge base again beside the old one, then replaces that in one step.

Runs that have opened the old index keep it. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from prefect import flow
from prefect.client.schemas.objects import State
from prefect.states import Completed

from flows.index_commands import DEFAULT_INDEX, SKIPPED, retriever_of


@flow(name="reindex", persist_result=False)
def reindex_flow(
    folder: str = str(DEFAULT_INDEX),
    files: list[str] | None = None,
    embedder: str = "none",
    model: str = "",
    base_url: str = "",
    builtin: bool = True,
) -> State[Any]:
    """Build the index of the `lancedb` retriever, as `sgcad index build` does; the message names its version."""
    retriever = retriever_of(Path(folder), embedder=embedder, model=model, base_url=base_url)
    skipped: list[str] = []
    chunks = retriever.chunks(
        [Path(f) for f in files or ()], builtin, lambda name, reason: skipped.append(f"{name}: {reason}")
    )
    manifest = retriever.build(chunks, lambda count: None)
    if skipped:
        (Path(folder) / SKIPPED).write_text("\n".join(skipped) + "\n", encoding="utf-8")
    return Completed(message=f"{manifest.stamp}: {manifest.chunks} chunks, {len(skipped)} left out")
