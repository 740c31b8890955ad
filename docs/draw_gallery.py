"""Draws the gallery: `python docs/draw_gallery.py [RUNS]`. Needs the package and its environment.

Turns every report in docs/gallery/reports into a scenario with the rules alone, copies the pictures beside them (at
most 60 kB each) and writes docs/gallery.md with the report, the verdict and the traffic rules that were broken.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from sgcad_core.rules.records import WORDS

DOCS = Path(__file__).resolve().parent
GALLERY = DOCS / "gallery"
PROGRAM = str(Path(sys.executable).parent / "sgcad")
MOST_BYTES = 60_000
HEAD = """# Gallery

Twelve crashes of different kinds. The reports were written for this page. Every picture was made from the text alone by
`python docs/draw_gallery.py` (config `template.yaml`), and nothing was mended by hand; the verdict is the tool's own.
"""


def main(arguments: list[str]) -> int:
    """Write the page; the exit code of the runs."""
    with tempfile.TemporaryDirectory() as made:
        runs = Path(arguments[0]) if arguments else Path(made)
        order = [
            "evaluate",
            str(GALLERY / "reports"),
            "--config",
            "template.yaml",
            "--out",
            str(runs),
            "--set",
            "tracker=none",
        ]
        ended = subprocess.run([PROGRAM, *order], check=False)  # noqa: S603 - our own command
        parts = [_part(file, runs / "template" / file.stem) for file in sorted((GALLERY / "reports").glob("*.txt"))]
    (DOCS / "gallery.md").write_text("\n".join([HEAD, *parts]), encoding="utf-8")
    return ended.returncode


def _part(report: Path, folder: Path) -> str:
    """One crash: picture, report, verdict, rules."""
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    _picture(folder / "picture.png", GALLERY / f"{report.stem}.png")
    broken = {f"{f['actor']} {WORDS[f['rule']]}": None for f in result["rules"] if f["status"] == "broken"}
    title = report.stem.replace("-", " ").capitalize()
    verdict = result["account"]["sentence"]
    rules = f"Rules: {', '.join(broken)}." if broken else "Rules: none is broken, as far as the map tells."
    text = report.read_text(encoding="utf-8").strip()
    head = f"## {title}\n\n![{title}](gallery/{report.stem}.png)\n\n"
    return f"{head}> {text}\n\nVerdict: {verdict}.\n\n{rules}\n"


def _picture(source: Path, target: Path) -> None:
    """The picture with as many colors as fit the bound."""
    with Image.open(source) as picture:
        small = picture.convert("RGB")
    small.thumbnail((900, 900))
    for colors in (128, 64, 32):
        small.quantize(colors).save(target, optimize=True)
        if target.stat().st_size <= MOST_BYTES:
            return
    raise SystemExit(f"{target}: {target.stat().st_size} bytes with 32 colors; at most {MOST_BYTES}")


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
