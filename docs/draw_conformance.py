"""Writes docs/conformance.md from the code: `python docs/draw_conformance.py` from the repository's root."""

from __future__ import annotations

from pathlib import Path

from research.benchmarks.scenes.conformance import page

if __name__ == "__main__":
    (Path(__file__).parent / "conformance.md").write_text(page(), encoding="utf-8")
