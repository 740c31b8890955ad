"""player.html: one executed case in a single page that needs no network and no server.

Put together from player.html, player.css, the SCRIPTS and the case's data. The data are in a JSON block, never in
markup, so a narrative cannot become code.
"""

from __future__ import annotations

import html
import json
import re
from functools import cache
from pathlib import Path

from flows.player.player_data import View

HERE = Path(__file__).parent
SCRIPTS = ("player.js", "player_tools.js", "player_words.js")
"""One function, in three files: stage and clock; helpers, units, plots, layers, runs; words and tables."""
SLOT = re.compile(r"%TITLE%|%DATA%|/\*STYLE\*/|/\*SCRIPT\*/")


def page(view: View) -> str:
    """The whole page as text."""
    data = json.dumps(view.as_json(), ensure_ascii=False, separators=(",", ":"))
    parts = {
        "%TITLE%": html.escape(f"{view.record.case} · {view.record.config}"),
        "/*STYLE*/": _part("player.css"),
        "/*SCRIPT*/": '"use strict";\n(() => {\n' + "".join(map(_part, SCRIPTS)) + "})();\n",
        "%DATA%": data.replace("<", "\\u003c"),
    }
    return SLOT.sub(lambda slot: parts[slot[0]], _part("player.html"))  # in one pass: contents hold no slots


@cache
def _part(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")
