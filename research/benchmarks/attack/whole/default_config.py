"""Cases with odd pictures and odd texts, the whole way through the default config to their folders."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from research.benchmarks.attack.reports.picture import FORMATS, MODES, picture, saved
from research.benchmarks.fuzz.making import changed, report
from sgcad_core import settings
from sgcad_core.errors import BadInput

NAME = "default config"
COUNT, LIMIT_S, SLOW_S = 100, 300.0, 60.0
"""A case of the default config asks a model on the processor: its time is the model's."""
SUFFIXES = ("png", "jpg", "gif", "bmp", "tif", "webp")


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Case folders: a report, half of them changed, and up to three pictures."""
    bundled = [file.read_text(encoding="utf-8") for file in sorted((settings.ROOT / "docs/demo").glob("*/report.txt"))]
    for number in range(10**9):
        (case := folder / f"case-{number}").mkdir()
        text = rng.choice(bundled)
        style = rng.random()
        odd = report(rng) if style < 0.2 else changed(text, rng)
        (case / "report.txt").write_bytes(text.encode() if style > 0.5 else odd)
        for one in range(rng.choice((1, 1, 2, 3))):
            drawn = picture(rng) if rng.random() < 0.3 else saved(rng.choice(FORMATS), rng.choice(MODES))
            more = rng.choice((b"", b"", rng.randbytes(99)))
            (case / f"scene-{one}.{rng.choice(SUFFIXES)}").write_bytes(drawn + more)
        yield case


@cache
def _config() -> Any:
    from sgcad_core.config import load

    return load(Path(settings.default_config()), ("tracker=none",))


def feed(item: Path) -> None:
    """Run the case. Raises BadInput where it ends without a scenario, AssertionError where a bug cost it."""
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case

    result = run_case(_config(), Case(item, item.name), Path(os.environ["TMPDIR"]) / "out", "").result
    reason = str(result["reason"])
    if result["status"] == "failed" and ("unexpected" in reason or "mend that plugin" in reason):
        raise AssertionError(reason[:200])
    if result["status"] != "generated":
        raise BadInput(reason)
