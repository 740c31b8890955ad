"""How well do the rules that read narratives do on made reports? Prints figures field by field.

    python -m research.benchmarks.texts.rules [--count 1000] [--held-out] [--base SEED] [--show FIELD]

Reports without a drawing from mini's generator, compared with their own truth by mini's own counting, so the
figures stand beside those of the model: a field counts where the narrative tells it. Two conventions are
evened out: a speed told as a range may be off by one, and a through lane that also serves a turn is a through
lane. `--held-out` takes the phrase families that neither the model nor the rules were made on; show their
figures only, never their failures. Knows nothing of real reports.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any

from research.generator.report import Report, make_report
from research.rows.row_stream import HELD_OUT_BASE
from research.training.evaluate import Answer, fields, source, tally
from sgcad_core.errors import Refused
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import Defaults, layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Compass
from sgcad_core.roads.layout import COMPASS, road_spec

DEFAULTS = Defaults(lanes_each_way=1, speed_limit_mph=35)
NOISE = 0.6
"""Share of the usual sentences that tell nothing of the scene, as in mini's own figures."""
NOTHING: dict[str, Any] = {"actors": [], "contacts": [], "light": None, "weather": None, "surface": None}
"""The behavior of a report that is refused."""
_POINTS: tuple[Compass, ...] = tuple(COMPASS)
_SHARED = {"through_right": "through", "left_through": "through"}
_ROAD_FIELDS = ("junction", "legs", "lanes", "median", "control", "turns", "curve", "speed_limit")


def report_of(seed: int, held_out: bool) -> Report:
    """The made report of a seed, its conventions evened out with those of the rules."""
    report = make_report(seed, held_out, NOISE, {"text": 1.0})
    for leg in report.road["legs"]:
        leg["turns_in"] = _through(leg["turns_in"])
    return report


def answer_of(report: Report) -> Answer:
    """The rules' reading of a report in the form of the model's answers; no actors and no contacts if refused."""
    facts = read(report.narrative).roads
    layout = layout_of_facts(facts, DEFAULTS)
    try:
        behavior = behavior_of_facts(facts.crash, road_spec(layout)).model_dump(mode="json")
    except Refused:
        behavior = dict(NOTHING)
    headings = {v.id: v.heading for v in facts.crash.vehicles}
    speeds = {actor["id"]: actor["speed_mph"] for actor in (report.behavior or {}).get("actors", ())}
    for actor in behavior["actors"]:
        heading = headings.get(actor["id"])
        actor["road"] = _opposite(heading) if heading else actor["road"]
        actor["speed_mph"] = _near(actor["speed_mph"], speeds.get(actor["id"]))
    road = layout.model_dump(mode="json")
    for leg in road["legs"]:
        leg["turns_in"] = _through(leg["turns_in"])
    return road, behavior


def _opposite(heading: Compass) -> Compass:
    """The leg that a vehicle comes in on."""
    return _POINTS[(_POINTS.index(heading) + 4) % 8]


def _near(got: int | None, want: int | None) -> int | None:
    return want if got and want and abs(got - want) <= 1 else got


def _through(turns: list[str]) -> list[str]:
    return [_SHARED.get(turn, turn) for turn in turns]


def failures(field: str, reports: list[Report], answers: list[Answer]) -> Iterator[str]:
    """Each report with a wrong value of that field: text, truth and answer."""
    for report, answer in zip(reports, answers, strict=True):
        if any(name == field and not right and source(report, key) == "text"
               for name, key, right in fields(report, answer)):  # fmt: skip
            want, got = _answer_part(field, (report.road, report.behavior)), _answer_part(field, answer)
            yield f"----- {report.seed}\n{report.narrative}\nWANT {want}\nGOT  {got}\n"


def _answer_part(field: str, answer: Answer) -> str:
    """The part of an answer that the field is about, on one line."""
    road, behavior = answer
    if field in _ROAD_FIELDS:
        keys = ("bearing", "lanes_in", "lanes_out", "turns_in", "median", "control", "curve", "speed_limit_mph")
        return " | ".join(" ".join(str(leg[k]) for k in keys) for leg in road["legs"])
    if field in ("light", "weather", "surface"):
        return str(behavior[field])
    actor_keys = ("id", "road", "kind", "maneuver", "lane", "speed_mph")
    actors: list[Any] = [tuple(actor[k] for k in actor_keys) for actor in behavior["actors"]]
    return json.dumps([actors, behavior["contacts"]])


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.benchmarks.texts.rules", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--held-out", action="store_true", help="phrase families that nothing was made on")
    parser.add_argument("--base", type=int, default=HELD_OUT_BASE, help="first seed")
    parser.add_argument("--show", metavar="FIELD", help="print the reports in which this field is wrong")
    options = parser.parse_args(arguments)
    if options.held_out and options.show:
        parser.error("--show would look at held-out failures; drop one of the two")
    reports = [report_of(options.base + i, options.held_out) for i in range(options.count)]
    started = time.process_time()
    answers = [answer_of(report) for report in reports]
    spent = (time.process_time() - started) / max(1, len(reports))
    if options.show:
        sys.stdout.write("\n".join(failures(options.show, reports, answers)))
        return
    for name, (share, count) in sorted(tally(reports, answers).get("text", {}).items()):
        sys.stdout.write(f"{name:15s} {share:.3f}  n={count}\n")
    refused = sum(not behavior["actors"] for _, behavior in answers)
    sys.stdout.write(f"refused, which counts as unread: {refused} of {len(answers)}\n")
    sys.stdout.write(f"processor time of the rules a report: {1000 * spent:.0f} ms\n")


if __name__ == "__main__":
    main()
