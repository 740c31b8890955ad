"""Inputs that no report, answer or file of ours is, made from a seed: words out of order, bytes, depth, changed values.

Knows nothing of the readers.
"""

from __future__ import annotations

import json
import random
import re
import tempfile
from functools import cache
from pathlib import Path

WORDS = """V1|V2|V3|V99|Vehicle #1|Vehicle #2|the Waymo AV|a pedestrian|a cyclist|Unit 1|the driver|a tree|a guardrail
an animal|was traveling|was stopped|struck|was struck by|did not touch|turned left|turned right|changed lanes|backed
crossed the centerline|departed the road|rotated|came to rest|merged|north|eastbound|southwest|the front of|its|his|not
the left side of|the right rear|at an intersection|on a two-lane road|on a divided highway|in a roundabout|at 45 mph|no
in a parking lot|at 999999999999 mph|-3.6%|lane 2 of 400|a speed limit of 1e309 mph|.|. |,|;|(|)|"|'|and|or|but|U.S.|St.
a.m.|[REDACTED]|{}|%s|<b>|</p>|&amp;|$x|=1+1|0x7f|1/0|NaN|Infinity"""
ODD = ("\n", "\n\n", "\x00", "\x1b[31m", "\u202e", "\ufffd", "\u00e9", "\u6f22\u5b57", "\U0001f697")
PIECES = (*WORDS.replace("\n", "|").split("|"), *ODD)
NUMBERS = (
    "", "0", "-1", "nan", "-INF", "1e309", "1e9", "9" * 400, "0x10", "1/0", "$v", "\u00e9", "-0", "1e-320",
    "2147483648",
)  # fmt: skip


def report(rng: random.Random) -> bytes:
    """Mostly words of reports, sometimes bytes, depth or one word many times."""
    style = rng.random()
    if style < 0.1:
        return rng.randbytes(rng.randrange(2000))
    if style < 0.15:
        return (rng.choice(PIECES) * rng.randrange(1, 3000))[:20_000].encode()
    words = [rng.choice(PIECES) for _ in range(rng.randrange(1, 150))]
    start = "The crash occurred on a two-lane road. " if style < 0.7 else ""
    return (start + " ".join(words)).encode("utf-8", "surrogatepass")


def deep(rng: random.Random) -> bytes:
    """XML in XML in XML, or many attributes."""
    depth, name = rng.choice((10, 300, 5000, 50_000)), rng.choice(("Case", "road", "a"))
    return (f"<{name}>" * depth + "x" + f"</{name}>" * rng.choice((depth, 0))).encode()


def case_xml(rng: random.Random) -> bytes:
    """NHTSA's form around a report, then changed."""
    text = report(rng).decode("utf-8", "replace").replace("<", "&lt;").replace("\x00", "")
    whole = f"<Case><CaseForm><CaseSummary><Summary>{text}</Summary></CaseSummary></CaseForm></Case>"
    return deep(rng) if rng.random() < 0.05 else changed(whole, rng)


PDF = (
    "<</Type/Catalog/Pages 2 0 R>>",
    "<</Type/Pages/Kids[3 0 R]/Count 1>>",
    "<</Type/Page/Parent 2 0 R/MediaBox[0 0 612 792]/Contents 4 0 R/Resources<</Font<</F1 5 0 R>>>>>>",
    "<</Length {length}>> stream\n{page}\nendstream",
    "<</Type/Font/Subtype/Type1/BaseFont/Helvetica>>",
)
"""The objects of a page of text."""


def pdf(rng: random.Random) -> bytes:
    """A page with a report, then changed."""
    text = re.sub(r"[()\\\x00-\x1f]", " ", report(rng).decode("latin-1"))
    page = f"BT /F1 9 Tf 40 700 Td ({text}) Tj ET"
    whole, starts = "%PDF-1.4\n", []
    for number, what in enumerate(PDF, start=1):
        starts.append(len(whole))
        whole += f"{number} 0 obj {what.replace('{length}', str(len(page))).replace('{page}', page)} endobj\n"
    rows = "".join(f"{start:010d} 00000 n \n" for start in starts)
    end = f"xref\n0 6\n0000000000 65535 f \n{rows}trailer <</Root 1 0 R/Size 6>>\nstartxref\n{len(whole)}\n%%EOF\n"
    return changed(whole + end, rng)


def changed(text: str, rng: random.Random) -> bytes:
    """Up to four changes: a value, an element moved or gone, a cut, bytes."""
    for _ in range(rng.randrange(5)):
        spots = list(re.finditer(r'="[^"]*"', text)) if rng.random() < 0.6 else []
        if spots:
            spot = rng.choice(spots)
            text = f'{text[: spot.start()]}="{rng.choice(NUMBERS)}"{text[spot.end() :]}'
            continue
        start, size, place = rng.randrange(len(text) + 1), rng.randrange(400), rng.randrange(len(text) + 1)
        piece = rng.choice(("", text[start : start + size], rng.randbytes(rng.randrange(9)).decode("latin-1")))
        text = text[:place] + piece + text[place + rng.choice((0, 0, size)) :]
    return text.encode("utf-8", "surrogatepass")


def answer(rng: random.Random) -> bytes:
    """JSON as a model may answer it."""
    if rng.random() < 0.05:
        return b"[" * rng.choice((100, 5000, 100_000)) + b"1"
    return changed(json.dumps(_json(rng, 4)) if rng.random() < 0.4 else _layout(), rng)


def _json(rng: random.Random, depth: int) -> object:
    keys = ("junction", "legs", "bearing", "lanes_in", "lanes_out", "refused", "reason", "actors", "collision", "nodes")
    leaves: list[object] = [None, True, -1, 10**400, 1.5, "N", "4-leg", rng.choice(PIECES), rng.choice(NUMBERS)]
    if depth == 0 or rng.random() < 0.3:
        return rng.choice(leaves)
    inner = [_json(rng, depth - 1) for _ in range(rng.randrange(4))]
    return inner if rng.random() < 0.4 else {rng.choice(keys): value for value in inner}


@cache
def example() -> tuple[str, str, str, str, str]:
    """A layout's JSON, net, xodr, xosc and trajectories of a small crash, as the default config makes them."""
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case
    from sgcad_core import settings
    from sgcad_core.config import load

    with tempfile.TemporaryDirectory() as place:
        source = Path(place) / "r.txt"
        source.write_text(
            "The crash occurred at a four-leg intersection in daylight. Vehicle #1 was traveling north. Vehicle #2 was "
            "traveling east. The front of Vehicle #1 struck the right side of Vehicle #2.", encoding="utf-8",
        )  # fmt: skip
        run_case(load(settings.CONFIGS / "template.yaml", ("tracker=none",)), Case(source, "r"), Path(place), "")
        case = Path(place) / "template" / "r"
        made = ("road.net.xml", "road.xodr", "scenario.xosc", "trajectories.csv")
        net, xodr, xosc, rows = ((case / name).read_text(encoding="utf-8") for name in made)
        return (case / "attempts" / "road-01" / "answer.txt").read_text(encoding="utf-8"), net, xodr, xosc, rows


def _layout() -> str:
    leg = {"bearing": "N", "lanes_in": 1, "lanes_out": 1, "control": "none", "speed_mph": 35}
    return example()[0] or json.dumps({"legs": [leg]})
