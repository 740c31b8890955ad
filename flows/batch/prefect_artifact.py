"""A case's artifact in Prefect: what came of it, what lacks, its picture and where to look, as markdown.

Pure words and one small picture; flows/batch/evaluate_flow.py hands it to the server.
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flows.case import case_in_words, case_links
from flows.case.case_links import Served
from sgcad_core.result import counts_of

WIDE_PX, COLORS = 420, 32
"""Of the picture: 10 to 20 kB, since it lies in the server's database."""
MOST_LACKING = 5


def key_of(name: str) -> str:
    """A case's name as a key of artifacts: small letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:200] or "case"


def markdown(folder: Path, result: Mapping[str, Any], served: Served) -> str:
    """The artifact of a case that lies in a folder."""
    parts = [
        f"# {_plain(folder.name)}: {_plain(_verdict(result))}",
        _picture(folder),
        *_told(result),
        _links(folder, served),
    ]
    return "\n\n".join(filter(None, parts)) + "\n"


def _verdict(result: Mapping[str, Any]) -> str:
    account = counts_of(result)
    lacking = f", {account['lacking']} of {account['told']} told lacking" if account and account["lacking"] else ""
    return f"{result['status']}{lacking}"


def _told(result: Mapping[str, Any]) -> list[str]:
    """What happens or why nothing does, and the account as a table."""
    if result["status"] != "generated":
        return [_plain(str(result["reason"] or result["status"])[:500])]
    near = result.get("near_crash")
    found = [_plain(case_in_words.approach(near) if near else _contact(result))]
    if account := counts_of(result):
        row = " | ".join(str(account[name]) for name in ("told", "has", "lacking", "assumed"))
        found.append(f"| told | in the scenario | lacking | assumed |\n|---|---|---|---|\n| {row} |")
        if account["lacking"]:
            found.append(f"Lacking: {_plain(case_in_words.lacking_in_words(account, MOST_LACKING))}.")
    return found


def _contact(result: Mapping[str, Any]) -> str:
    collision = result["collision"]
    return case_in_words.contact(result) if collision["declared"] or collision["observed"] else "no contact is told"


def _picture(folder: Path) -> str:
    """The case's picture, small; "" where there is none that can be read."""
    from PIL import Image

    try:
        with Image.open(folder / "picture.png") as found:
            small = found.convert("RGB")
    except OSError:
        return ""
    small.thumbnail((WIDE_PX, WIDE_PX))
    out = io.BytesIO()
    small.quantize(COLORS).save(out, "PNG", optimize=True)
    return f"![The crash from above](data:image/png;base64,{base64.b64encode(out.getvalue()).decode('ascii')})"


def _links(folder: Path, served: Served) -> str:
    """Where to look: pages that are served, and the folder."""
    kept = case_links.kept(folder)
    mlflow = case_links.resolved(kept["mlflow"], served.mlflow) if "mlflow" in kept else ""
    found = [("Desk", served.case_page(folder)), ("MLflow run", mlflow)]
    if mlflow and (folder / "player.html").is_file():
        found.append(("Report page (player.html among the run's files)", f"{mlflow}/artifacts"))
    lines = [f"- [{name}]({address})" for name, address in found if address]
    page = folder / ("player.html" if (folder / "player.html").is_file() else "result.json")
    return "\n".join([*lines, f"- `{page}`"])


def _plain(text: str) -> str:
    """Words as markdown shows them: no markup, no HTML."""
    return re.sub(r"([\\`*_\[\]<>|#!])", r"\\\1", " ".join(text.split()))
