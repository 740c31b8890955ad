"""Options of trainings that take seconds."""

from pathlib import Path


def options(folder: Path, steps: int) -> list[str]:
    """`steps` of eight, of a tiny model on one process."""
    return [
        "--out", str(folder), "--size", "tiny", "--workers", "0", "--ranks", "1", "--texts", "100", "--tokens", "1500",
        "--total-steps", "8", "--max-steps", str(steps), "--budget", "1000", "--stage", "all",
    ]  # fmt: skip
