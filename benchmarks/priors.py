"""What does contrast do to a model that believes something beforehand? Closed questions about real reports.

    python -m benchmarks.priors --model FOLDER_OR_GGUF [--adapter FOLDER] [--gist PROMPT] --dev CASES TRUTH
                                [--pool POOL.jsonl] [--count 200] [--out JSON] [--rows ROWS.jsonl]

Reports are those of `benchmarks.incidents`: narratives with coded truth. Each is asked what its codes answer: whether
anybody touched, what the subject and the other were doing, where the subject was hit. A question is *against the prior*
where the model, asked without the report, answers otherwise than the codes; contrast is meant for these. Every arm sees
the same logits (benchmarks/options.py). Brackets are 95 % bootstrap intervals over reports: of the share right, and of
its difference to greedy on the same reports; p is a paired permutation test against greedy, Holm's correction over the
arms of a column. Below stands log p of the right answer with and without the report, where greedy answers right and
where it does not. --rows keeps every answer, so that a broken run goes on; it holds no text. With --gist the questions
are the fields of a second opinion's answer (benchmarks/gist_heard.py), in the prompt that an adapter learned.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch

from benchmarks.gist_heard import GistListener
from benchmarks.incidents import Incident, by_hash, of_dev, of_pool
from benchmarks.opinions import codes
from benchmarks.opinions import right as is_right
from benchmarks.options import Heard, Listener, decode
from mini.told import OPTIONS
from plugins.backbone.hf_gguf import is_gguf, unpacked
from plugins.backbone.hf_load import load
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.plausible import Plausible
from sgcad_core.asking.prompts import load_prompt
from sgcad_core.interfaces import Decoder
from sgcad_core.metrics.statistics import holm, ratio_interval, swap_test

ARMS: dict[str, Decoder] = {
    "greedy": Greedy(),
    "plausibility": Plausible(beta=0.1),
    **{f"alpha {alpha}": Cad(alpha=alpha) for alpha in (0.3, 0.5, 0.7, 1.0, 2.0)},
    "alpha 0.7, masked": Cad(alpha=0.7, beta=0.1),
    "adaptive": AdaCad(),
}
_MOVES = {
    "going straight": ("straight", "slowing", "passing", "entering", "accelerating"),
    "stopped": ("stopped", "parked"),
    "turning left": ("turn_left",),
    "turning right": ("turn_right",),
    "changing lanes": ("lane_change", "merging"),
    "backing": ("backing",),
}
_AREAS = {"front": "front", "rear": "back", "left side": "left", "right side": "right"}


@dataclass(frozen=True)
class Question:
    """`right` gives the options that the codes call right; none where they do not say."""

    text: str
    options: tuple[str, ...]
    right: Callable[[Mapping[str, Any]], frozenset[str]]


def _moving(who: str, truth: Mapping[str, Any]) -> frozenset[str]:
    coded = (truth.get(who) or {}).get("manoeuvre")
    return frozenset(option for option, codes in _MOVES.items() if coded in codes)


def _touched(truth: Mapping[str, Any]) -> frozenset[str]:
    return frozenset({"yes" if truth["contact"] else "no"})


def _hit(truth: Mapping[str, Any]) -> frozenset[str]:
    areas = " ".join(truth["subject"].get("areas") or ()) if truth["contact"] else ""
    return frozenset(option for option, word in _AREAS.items() if word in areas)


def _asking(what: str, options: Sequence[str]) -> str:
    return f"{what} Answer with one of: {', '.join(options)}."


QUESTIONS: dict[str, Question] = {
    "contact": Question(_asking("Did the vehicles touch?", ("yes", "no")), ("yes", "no"), _touched),
    "subject": Question(
        _asking("What was the automated or subject vehicle doing before the event?", tuple(_MOVES)),
        tuple(_MOVES), partial(_moving, "subject"),
    ),
    "other": Question(
        _asking("What was the other road user doing before the event?", tuple(_MOVES)),
        tuple(_MOVES), partial(_moving, "other"),
    ),
    "area": Question(
        _asking("Which part of the automated or subject vehicle was hit?", tuple(_AREAS)), tuple(_AREAS), _hit
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """One question about one report."""

    report: str
    field: str
    group: str
    against: bool
    """Whether the codes say otherwise than the model does without the report."""
    right: Mapping[str, bool]
    """By arm."""
    log_p: tuple[float, float]
    """Of the likeliest right option, with the report and without it, nats."""


_TEXTS = {question.text: question.options for question in QUESTIONS.values()}


class Told(NamedTuple):
    """By field: the right options, and what was heard with the report and without it."""

    right: Mapping[str, frozenset[str]]
    heard: Mapping[str, Heard]
    priors: Mapping[str, Heard]


def closed(listener: Listener) -> Callable[[Incident], Told]:
    """Asks the questions above."""
    priors = dict(zip(QUESTIONS, listener.hear("", _TEXTS), strict=True))

    def tell(incident: Incident) -> Told:
        right = {field: question.right(incident.truth) for field, question in QUESTIONS.items()}
        return Told(right, dict(zip(QUESTIONS, listener.hear(incident.text, _TEXTS), strict=True)), priors)

    return tell


def of_gist(listener: GistListener) -> Callable[[Incident], Told]:
    """Asks for the fields of a gist, of which the codes allow some values; those that move alike are right too."""

    def tell(incident: Incident) -> Told:
        heard, said = listener.hear(incident.text)
        known = codes(incident.truth)
        right = {
            field: frozenset(value for value in OPTIONS[field] if is_right(json.loads(value), known.get(field, ())))
            for field in OPTIONS
        }
        return Told(right, heard, listener.hear("", said)[0])

    return tell


def asked(tell: Callable[[Incident], Told], incidents: Sequence[Incident], rows: Path | None = None) -> list[Asked]:
    """Every question that a report's codes answer; those that a file of rows holds from before are not asked again."""
    known = _kept(rows)
    found = []
    for incident in incidents:
        if incident.id not in known:
            known[incident.id] = _of_report(tell(incident), incident)
            _keep(rows, incident.id, known[incident.id])
        found += known[incident.id]
    return found


def _of_report(told: Told, incident: Incident) -> list[Asked]:
    right, heard, priors = told
    found = []
    for field in (field for field in right if right[field]):
        verdicts = {arm: decode(d, heard[field], priors[field]) in right[field] for arm, d in ARMS.items()}
        against = decode(ARMS["greedy"], priors[field], priors[field]) not in right[field]
        sure = _log_p(heard[field], right[field]), _log_p(priors[field], right[field])
        found.append(Asked(incident.id, field, incident.group, against, verdicts, sure))
    return found


def _kept(rows: Path | None) -> dict[str, list[Asked]]:
    lines = rows.read_text(encoding="utf-8").splitlines() if rows and rows.is_file() else []
    return {one["report"]: [Asked(**row) for row in one["answers"]] for one in map(json.loads, lines)}


def _keep(rows: Path | None, report: str, answers: Sequence[Asked]) -> None:
    if rows:
        with rows.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"report": report, "answers": [asdict(one) for one in answers]}) + "\n")


def _log_p(heard: Heard, right: frozenset[str]) -> float:
    return max(heard.log_p(option) for option in right)


# ------------------------------------------------------------------ tables
def _per_report(rows: Sequence[Asked], arm: str) -> tuple[Any, Any]:
    """Right answers and questions, one number a report."""
    names = sorted({row.report for row in rows})
    at = {name: i for i, name in enumerate(names)}
    hits, asked_of = np.zeros(len(names)), np.zeros(len(names))
    for row in rows:
        hits[at[row.report]] += row.right[arm]
        asked_of[at[row.report]] += 1
    return hits, asked_of


def column(rows: Sequence[Asked]) -> dict[str, dict[str, Any]]:
    """Share right by arm, with interval and corrected p against greedy."""
    if not rows:
        return {}
    sums = {arm: _per_report(rows, arm) for arm in ARMS}
    p = holm({arm: swap_test(sums["greedy"], sums[arm]) for arm in ARMS if arm != "greedy"})
    found = {}
    for arm, (hits, count) in sums.items():
        found[arm] = {
            "n": int(count.sum()), "right": round(float(hits.sum() / count.sum()), 3),
            "interval": _ends(hits, count), "more": _ends(hits - sums["greedy"][0], count) if arm in p else None,
            "p": round(p[arm], 4) if arm in p else None,
        }  # fmt: skip
    return found


def _ends(hits: Any, count: Any) -> list[float] | None:
    interval = ratio_interval(hits, count)
    return [round(interval.low, 3), round(interval.high, 3)] if interval else None


def columns(rows: Sequence[Asked]) -> dict[str, dict[str, dict[str, Any]]]:
    """All, against and with the prior, and by field."""
    parts = {
        "all": rows,
        "against the prior": [row for row in rows if row.against],
        "with the prior": [row for row in rows if not row.against],
        **{field: [row for row in rows if row.field == field] for field in dict.fromkeys(row.field for row in rows)},
    }
    return {name: column(part) for name, part in parts.items()}


def sureness(rows: Sequence[Asked]) -> dict[str, dict[str, float]]:
    """Mean log p of the right answer with and without the report, where greedy is right and where it is not."""
    found = {}
    for field in dict.fromkeys(row.field for row in rows):
        for verdict, word in ((True, "right"), (False, "wrong")):
            own = np.array([row.log_p for row in rows if row.field == field and row.right["greedy"] is verdict])
            if len(own):
                with_report, without = own.mean(0)
                found[f"{field}, {word}"] = {
                    "n": len(own), "with": round(float(with_report), 2), "without": round(float(without), 2)
                }  # fmt: skip
    return found


def show(table: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """One line an arm for every column."""
    lines = []
    for name, arms in table.items():
        lines.append(f"\n{name}")
        for arm, cell in arms.items():
            low, high = cell["interval"] or (float("nan"), float("nan"))
            p = "" if cell["p"] is None else f"  to greedy {_signed(cell['more'])}  p {cell['p']:.4f}"
            lines.append(f"  {arm:<18} {cell['right']:.3f} [{low:.3f}, {high:.3f}]  n {cell['n']}{p}")
    return "\n".join(lines)


def _signed(ends: Sequence[float] | None) -> str:
    return "[{:+.3f}, {:+.3f}]".format(*ends) if ends else "-"


def _sure(found: Mapping[str, Any]) -> list[str]:
    return [
        f"  log p, {name:<18} with {cell['with']:8.2f}  without {cell['without']:8.2f}  n {cell['n']}"
        for name, cell in found["log p"].items()
    ]


def main() -> None:
    """Ask, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--model", required=True)
    parser.add_argument("--adapter", help="folder of a LoRA adapter")
    parser.add_argument("--gist", metavar="PROMPT", help="ask as this prompt of configs/prompts does")
    parser.add_argument("--most", type=int, help="development reports at most, as their hashes fall")
    parser.add_argument("--dev", nargs=2, type=Path, metavar=("CASES", "TRUTH"))
    parser.add_argument("--pool", type=Path)
    parser.add_argument("--count", type=int, default=200, help="reports of the pool that nobody reads (0 = all)")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--rows", type=Path, help="file of answers, made or gone on with")
    given = parser.parse_args()
    incidents = sorted(of_dev(*given.dev), key=lambda one: by_hash(one.id))[: given.most] if given.dev else []
    blind = [i for i in of_pool(given.pool, 0) if i.group == "blind"] if given.pool else []
    incidents += blind[: given.count or None]
    place = str(unpacked(given.model)) if is_gguf(given.model) else given.model
    loaded = load(place, None, {"dtype": torch.float32}, "cpu", "none", given.adapter)
    tell = of_gist(GistListener(loaded, load_prompt(given.gist))) if given.gist else closed(Listener(loaded))
    started = time.monotonic()
    rows = asked(tell, incidents, given.rows)
    groups = {group: [r for r in rows if r.group == group] for group in ("dev", "blind")}
    report = {group: {"accuracy": columns(own), "log p": sureness(own)} for group, own in groups.items() if own}
    lines = [
        line for group, found in report.items() for line in (f"\n== {group}", show(found["accuracy"]), *_sure(found))
    ]
    sys.stdout.write("\n".join([*lines, f"\n{len(incidents)} reports in {time.monotonic() - started:.0f} s", ""]))
    if given.out:
        given.out.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
