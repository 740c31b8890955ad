"""player.html: one executed case in a single page that needs no network and no server.

Put together from player.html, player.css, the SCRIPTS and the case's data. The data are in a JSON block, never in
markup, so a narrative cannot become code.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from flows.player.player_data import View, traffic_shown
from flows.player.sentence_marks import Place, ToldSentence, told_sentences
from sgcad_core.case.traffic import Background

HERE = Path(__file__).parent
SCRIPTS = ("player.js", "player_tools.js", "player_words.js")
"""One function, in three files: stage and clock; helpers, units, plots, layers, runs; words and tables."""
SLOT = re.compile(r"%TITLE%|%DATA%|/\*STYLE\*/|/\*SCRIPT\*/")

DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


def page(view: View) -> str:
    """The whole page as text."""
    return _page(view.as_json())


def page_among(page: str, traffic: Background) -> str:
    """A page that was written, anew with background vehicles. Raises ValueError for a text that is no such page."""
    found = DATA.search(page)
    if found is None:
        raise ValueError("it has no data of a player")
    return _page(json.loads(found[1]) | {"traffic": traffic_shown(traffic)})


def told_in(page: str, result: Mapping[str, Any]) -> list[ToldSentence]:
    """The sentences of a case, with their places in the narrative as a player's page (or "") shows it."""
    items = (result.get("account") or {}).get("items") or ()
    return told_sentences(result.get("facts") or (), items, shown_in(page))


def shown_in(page: str) -> Callable[[Place], Place]:
    """Where the sentences that a player's page tells of stand in its narrative; as written where it tells of none."""
    found = DATA.search(page)
    try:
        told = json.loads(found[1])["sentences"] if found else ()
        spans = {int(s["of"]): (int(s["start"]), int(s["end"])) for s in told}
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        spans = {}
    return lambda place: spans.get(place[0], place)


def _page(shown: Mapping[str, Any]) -> str:
    data = json.dumps(shown, ensure_ascii=False, separators=(",", ":"))
    parts = {
        "%TITLE%": html.escape(f"{shown['case']} · {shown['config']}"),
        "/*STYLE*/": _part("player.css"),
        "/*SCRIPT*/": '"use strict";\n(() => {\n' + "".join(map(_part, SCRIPTS)) + "})();\n",
        "%DATA%": data.replace("<", "\\u003c"),
    }
    return SLOT.sub(lambda slot: parts[slot[0]], _part("player.html"))  # in one pass: contents hold no slots


@cache
def _part(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")
