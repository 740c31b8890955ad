"""Files that cases wrote below a folder of runs, each once."""

from __future__ import annotations

from pathlib import Path

COPIES = "mlflow-artifacts"
"""Folder in which MLflow's tracker keeps a second copy of every case."""


def written_files(folder: Path, pattern: str) -> list[Path]:
    """Files below the folder that match, sorted; without the copies that a tracker keeps under it."""
    return sorted(file for file in folder.rglob(pattern) if COPIES not in file.relative_to(folder).parts)
