"""Report texts: words of reports in wrong orders, bundled reports changed, odd encodings, controls, length."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path

from research.benchmarks.fuzz.making import PIECES, changed, report
from sgcad_core import settings

NAME = "report text"
_WORDS = (
    "V1", "V2", "Vehicle #1", "struck", "the front of", "(", ")", ",", ".", "and", "lane", "1", "mph", "N", "-",
    "\u2019s",
    "[XXX]", "the left side of", "\u200b", "turned", "U.S.",
)  # fmt: skip


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Text files."""
    bundled = [file.read_text(encoding="utf-8") for file in sorted((settings.ROOT / "docs/demo").glob("*/report.txt"))]
    for number in range(10**9):
        file = folder / f"report-{number}.txt"
        file.write_bytes(_made(rng, bundled))
        yield file


def _made(rng: random.Random, bundled: list[str]) -> bytes:
    style = rng.random()
    if style < 0.4:
        return report(rng)
    if style < 0.7:
        return changed(rng.choice(bundled), rng)
    if style < 0.85:
        return _odd(rng, rng.choice(bundled)).encode(rng.choice(("utf-8", "utf-16", "utf-32", "cp1252")), "replace")
    return _evil(rng)


def _odd(rng: random.Random, text: str) -> str:
    """A report whose sentences, cases, numbers or spaces are others."""
    words = text.split(" ")
    ways: tuple[Callable[[], str], ...] = (
        lambda: " ".join(rng.sample(words, len(words))),
        text.upper,
        text.swapcase,
        lambda: text.replace("1", str(rng.randrange(10**9))),
        lambda: text.replace(" ", rng.choice(("\u00a0", "\u3000", "\t", "\n", "  ", "\r\n", "\u2028"))),
        lambda: text.replace(". ", rng.choice(("; ", ".", "!? ", "\u2026", ".\x0c"))),
        lambda: "".join(c if rng.random() > 0.02 else rng.choice(PIECES) for c in text),
        lambda: "\n".join(text for _ in range(rng.randrange(2, 30))),
    )
    return rng.choice(ways)()


def _evil(rng: random.Random) -> bytes:
    """Length, nesting, one thing many times, no text at all."""
    piece = rng.choice(_WORDS)
    size = rng.choice((10, 1000, 30_000, 99_000, 450_000))
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: (piece * size)[:size].encode(),
        lambda: (f"{piece} " * size)[:size].encode(),
        lambda: (" ".join(rng.choice(_WORDS) for _ in range(size // 4)))[:size].encode(),
        lambda: ("(" * (size // 2) + ")" * (size // 2)).encode(),
        lambda: ("The front of V1 struck the rear of V2. " * size)[:size].encode(),
        lambda: " ".join(f"V{n} struck V{n + 1}." for n in range(min(size, 9000))).encode()[:size],
        lambda: rng.randbytes(min(size, 100_000)),
        lambda: b"\xff\xfe" + rng.randbytes(min(size, 100_000)),
        lambda: b"",
    )
    return rng.choice(ways)()


def feed(item: Path) -> None:
    """Give a file to the default reader, and its narrative to the rules."""
    from plugins.report_reader.auto import Auto

    _ = Auto().read(item).reading
