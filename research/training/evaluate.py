"""Free-running figures on made reports with held-out phrase families: `python -m research.training.evaluate
plugins/backbone/mini/weights`.

A field counts in "text" where only the narrative tells it, in "diagram" where only the drawing does, in "both"
where both do; "blind" is the same diagram-only fields with the drawing taken away. Teacher-forced figures would
flatter and are not made.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import torch
from transformers import Qwen2_5_VLForConditionalGeneration

from plugins.backbone.mini import patch_convnet
from plugins.backbone.mini.patch_convnet import Sight
from research.generator.report import Report, make_report
from research.model.answer_grammar import COMPASS
from research.model.decode import Answerer
from research.model.model import Forward
from research.model.tokens import Coder, load_tokenizer
from research.rows.report_rows import evidence
from research.rows.row_stream import HELD_OUT_BASE, drawing

MODES = {"both": 40.0, "image": 25.0, "text": 25.0, "thin": 3.4, "no_crash": 3.3, "conflict": 3.3}
REFUSED = ("thin", "no_crash", "conflict")
Answer = tuple[Any, Any]


def load(folder: Path) -> tuple[Forward, Coder, Sight]:
    """A saved model, in fp32 (a CPU without bf16 is slow in it), and what it sees drawings with."""
    model = Qwen2_5_VLForConditionalGeneration.from_pretrained(
        folder, dtype=torch.float32, local_files_only=True
    ).eval()
    sight = patch_convnet.load(folder)
    return Forward(model, sight.eye), Coder(load_tokenizer(folder)), sight


def answers_of(
    forward: Forward,
    coder: Coder,
    sight: Sight,
    reports: Sequence[Report],
    blind: bool = False,
    batch: int = 24,
    views: int = 1,
) -> list[Answer]:
    """Greedy answers, narratives alone first (they need one view), then by length; each drawing read in so many
    views."""
    seeing = [not blind and report.has_image for report in reports]
    order = sorted(range(len(reports)), key=lambda i: (seeing[i], len(reports[i].narrative)))
    found: dict[int, Answer] = {}
    answerer = Answerer(forward, coder)
    for start in range(0, len(order), batch):
        some = order[start : start + batch]
        drawings = [drawing(reports[i]) if seeing[i] else None for i in some]
        upright = [sight.upright(image) if image else None for image in drawings]
        rows, *others = (
            [evidence(coder, reports[i].narrative, image, view) for i, image in zip(some, upright, strict=True)]
            for view in range(views if any(upright) else 1)
        )
        found |= dict(zip(some, answerer.answer(rows, views=others), strict=True))
    return [found[i] for i in range(len(reports))]


# ------------------------------------------------------------------ fields
def fields(report: Report, answer: Answer) -> Iterator[tuple[str, str, bool]]:
    """(field, fact key, right) for every value of a report that some source tells."""
    road, behavior = answer
    if "refuse" in report.road or report.behavior is None or "refuse" in report.behavior or "legs" not in road:
        return
    yield from _road_fields(report, road)
    if behavior is not None and "actors" in behavior:
        yield from _behavior_fields(report, behavior)


def _road_fields(report: Report, road: Any) -> Iterator[tuple[str, str, bool]]:
    want = {leg["bearing"]: leg for leg in report.road["legs"]}
    got = {leg["bearing"]: leg for leg in road["legs"]}
    turning = {COMPASS[leg.bearing]: leg.turns_in for leg in report.crash.legs}
    unplaced = " legs" * ("legs" in report.doubtful)  # what all meet may be told, but not where
    if len(want) > 2:
        yield "junction", "layout", len(got) > 2
    yield "legs", "legs", set(want) == set(got)
    for bearing, leg in want.items():
        axis = COMPASS.index(bearing) % 4
        have = got.get(bearing, {})
        hidden = f" turns.{axis}" if turning.get(bearing) else ""
        yield "lanes", f"lanes.{axis}{hidden}", all(have.get(k) == leg[k] for k in ("lanes_in", "lanes_out"))
        yield "median", f"median.{axis}", have.get("median") == leg["median"]
        yield "control", f"control{unplaced}", have.get("control") == leg["control"]
        if leg["turns_in"]:
            yield "turns", f"turns.{axis}", have.get("turns_in") == leg["turns_in"]
        if leg["curve"] != "none":
            yield "curve", "curve", have.get("curve") == leg["curve"]
        if leg["speed_limit_mph"]:
            yield "speed_limit", f"limit.{axis}", have.get("speed_limit_mph") == leg["speed_limit_mph"]


def _behavior_fields(report: Report, behavior: Any) -> Iterator[tuple[str, str, bool]]:
    want, got = report.behavior, {actor["id"]: actor for actor in behavior["actors"]}
    assert want is not None  # noqa: S101 - the caller asked
    for actor in want["actors"]:
        have, name = got.get(actor["id"], {}), actor["id"]
        yield "kind", f"kind.{name}", have.get("kind") == actor["kind"]
        yield "heading", f"heading.{name}", have.get("road") == actor["road"]
        yield "maneuver", f"man.{name}", have.get("maneuver") == actor["maneuver"]
        if actor["lane"] is not None:
            yield "lane", f"lane.{name}", have.get("lane") == actor["lane"]
        if actor["speed_mph"]:
            yield "speed", f"speed.{name}", have.get("speed_mph") == actor["speed_mph"]
    for i, contact in enumerate(want["contacts"][:1]):
        have = behavior["contacts"][i] if behavior["contacts"] else {}
        yield "striker_struck", f"contact.{i}", all(have.get(k) == contact[k] for k in ("striker", "struck"))
        yield "areas", f"areas.{i}", _sides(have) == _sides(contact)
    for key in ("light", "weather", "surface"):
        yield key, key, behavior[key] == want[key]


def _sides(contact: Any) -> dict[str, str]:
    """The touched areas by actor, whichever strikes."""
    return {contact[k]: contact[f"{k}_area"] for k in ("striker", "struck") if k in contact}


def source(report: Report, key: str) -> str:
    """Source of facts (one or several, apart by spaces): "text", "diagram", "both" or "none".

    What the narrative tells without saying which legs are meant stands in no source by itself.
    """
    facts = set(key.split())
    told, drawn = facts <= report.stated, report.has_image and facts <= report.drawn
    if facts & report.doubtful:
        return "both" if drawn else "none"
    return {(True, True): "both", (True, False): "text", (False, True): "diagram"}.get((told, drawn), "none")


def tally(
    reports: Iterable[Report], answers: Iterable[Answer], prefix: str = ""
) -> dict[str, dict[str, tuple[float, int]]]:
    """source -> field -> (share right, n)."""
    marks: dict[str, dict[str, list[bool]]] = defaultdict(lambda: defaultdict(list))
    for report, answer in zip(reports, answers, strict=True):
        for name, key, right in fields(report, answer):
            where = source(report, key)
            if where != "none":
                marks[prefix + where][name].append(right)
                marks[prefix + where]["ALL"].append(right)
    return {s: {f: (sum(m) / len(m), len(m)) for f, m in by.items()} for s, by in marks.items()}


def refusals(reports: Sequence[Report], answers: Sequence[Answer]) -> dict[str, float]:
    """Precision and recall of refusals (either stage)."""
    wanted = [r.mode in REFUSED for r in reports]
    got = ["refuse" in a[0] or (a[1] is not None and "refuse" in a[1]) for a in answers]
    both = sum(w and g for w, g in zip(wanted, got, strict=True))
    return {
        "precision": both / max(1, sum(got)),
        "recall": both / max(1, sum(wanted)),
        "wanted": sum(wanted),
        "given": sum(got),
    }


def measure(
    forward: Forward,
    coder: Coder,
    sight: Sight,
    count: int,
    held_out: bool = True,
    base: int = HELD_OUT_BASE,
    views: int = 1,
    modes: dict[str, float] = MODES,
) -> dict[str, Any]:
    """All figures on `count` reports; blind and sighted ones of those that have narrative and drawing."""
    reports = [make_report(base + i, held_out, 0.6, modes) for i in range(count)]
    found = answers_of(forward, coder, sight, reports, views=views)
    figures: dict[str, Any] = tally(reports, found)
    seeing = [i for i, r in enumerate(reports) if r.mode == "both"]
    some = [reports[i] for i in seeing]
    blind = tally(some, answers_of(forward, coder, sight, some, blind=True), "blind_")
    figures["blind"] = blind.get("blind_diagram", {})
    figures["sighted"] = tally(some, [found[i] for i in seeing]).get("diagram", {})
    figures["refusals"] = refusals(reports, found)
    return figures


def table(figures: dict[str, Any]) -> str:
    """Figures as lines of text."""
    lines = []
    for where, by in figures.items():
        if where == "refusals":
            lines.append(f"refusals  {json.dumps(by)}")
            continue
        lines += [f"{where:10s} {name:15s} {share:.3f}  n={n}" for name, (share, n) in sorted(by.items())]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.training.evaluate", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seen", action="store_true", help="the trained phrase families, new crashes")
    parser.add_argument("--views", type=int, default=1, help="layouts of a drawing whose predictions are averaged")
    parser.add_argument("--mode", choices=MODES, help="reports of this kind alone")
    parser.add_argument("--skip", type=int, default=0, help="so many reports of the series are passed over")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args(arguments)
    modes = {options.mode: 1.0} if options.mode else MODES
    base = HELD_OUT_BASE + options.skip
    figures = measure(*load(options.folder), options.count, not options.seen, base, options.views, modes)
    sys.stdout.write(table(figures) + "\n")
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
