"""What a case did, step by step, as a tree of spans: the case, its stages, their attempts, the model's answers.

Read from the case folder: steps.json (begin, end and state of every step), result.json, metrics.json and attempts/.
A folder without steps.json gets its steps from the durations, one after the other. Knows no tracking library.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from plugins.tracker.attempts import Attempt, attempts_of, read_json, text_of
from plugins.tracker.headline import in_words

KINDS = {"read": "PARSER", "retrieve": "RETRIEVER", "simulate": "TOOL", "measure": "EVALUATOR", "judge": "EVALUATOR",
         "drive": "TOOL", "files": "TASK", "draw": "TASK"}  # fmt: skip
"""MLflow's types of spans by step; of others CHAIN."""
CASE, MODEL = "WORKFLOW", "CHAT_MODEL"


@dataclass(frozen=True)
class Step:
    """A step that has ended; times in seconds since 1970."""

    name: str
    began_s: float
    ended_s: float
    state: str = "Completed"
    message: str = ""


@dataclass(frozen=True)
class Span:
    """A step with what it was given and what it gave. `tokens`: of the prompt and of the answer."""

    step: Step
    kind: str = "CHAIN"
    inputs: Any = None
    outputs: Any = None
    about: Mapping[str, Any] = field(default_factory=dict)
    tokens: tuple[int, int] | None = None
    findings: Sequence[Mapping[str, Any]] = ()
    children: tuple[Span, ...] = ()

    def all_tokens(self) -> tuple[int, int]:
        """Tokens of the prompts and answers of this span and all below it."""
        found = [child.all_tokens() for child in self.children] + [self.tokens or (0, 0)]
        return sum(prompt for prompt, _ in found), sum(answer for _, answer in found)


# ------------------------------------------------------------------ steps
def steps_of(case_dir: Path, result: Mapping[str, Any], attempts: Sequence[Attempt]) -> list[Step]:
    """The steps of steps.json; without that file the durations, so that the last step ends when the folder did."""
    kept = read_json(case_dir / "steps.json")
    names = Step.__dataclass_fields__
    if kept:
        return [Step(**{name: value for name, value in step.items() if name in names}) for step in kept]
    lasted = list(_lasted(result, attempts))
    file = case_dir / "result.json"
    now = (file if file.is_file() else case_dir).stat().st_mtime - sum(step.ended_s for step in lasted)
    laid = []
    for step in lasted:
        laid.append(replace(step, began_s=now, ended_s=now + step.ended_s))
        now += step.ended_s
    return laid


def _lasted(result: Mapping[str, Any], attempts: Sequence[Attempt]) -> Iterator[Step]:
    """Steps in their order that begin at 0."""
    for name, seconds in (result.get("seconds") or {}).items():
        tries = [a for a in attempts if a.stage == name]
        yield from [Step(f"{name}[{a.number}]", 0.0, a.seconds, a.state) for a in tries] or [Step(name, 0.0, seconds)]


def _stage(name: str) -> str:
    """The stage of an attempt such as "road[2]"; any other step's own name."""
    stage, _, number = name.partition("[")
    return stage if number[:-1].isdigit() else name


# ------------------------------------------------------------------ spans
def spans_of(case_dir: Path, result: Mapping[str, Any], model: str = "") -> Span:
    """The whole case; `model` names the model that was asked."""
    attempts = attempts_of(case_dir)
    steps = sorted(steps_of(case_dir, result, attempts), key=lambda step: step.began_s)
    metrics = read_json(case_dir / "metrics.json") or {}
    tries = {f"{a.stage}[{a.number}]": a for a in attempts}
    stages: dict[str, list[Step]] = {}
    for step in steps:
        stages.setdefault(_stage(step.name), []).append(step)
    children = [_of_stage(name, inner, tries, model, _gave(name, result, metrics)) for name, inner in stages.items()]
    whole = _around(case_dir.name, steps) or Step(case_dir.name, 0.0, 0.0)
    whole = replace(whole, state=result["status"], message=str(result.get("reason") or ""))
    told = {"narrative": text_of(case_dir / "report.txt")}
    return Span(whole, CASE, told, {"result": in_words(result)}, children=tuple(children))


def _around(name: str, steps: Sequence[Step]) -> Step | None:
    """A step over others, with the state of the last one."""
    if not steps:
        return None
    ended = max(step.ended_s for step in steps)
    return Step(name, min(step.began_s for step in steps), ended, steps[-1].state, steps[-1].message)


def _of_stage(name: str, steps: Sequence[Step], tries: Mapping[str, Attempt], model: str, gave: Any) -> Span:
    children = tuple(_of_attempt(step, tries.get(step.name), model) for step in steps if step.name != name)
    step = _around(name, steps) or steps[0]
    return Span(step, KINDS.get(name.partition("[")[0], "CHAIN"), outputs=gave, children=children)


def _of_attempt(step: Step, attempt: Attempt | None, model: str) -> Span:
    if attempt is None:
        return Span(step)
    asked = (_answer(step, attempt, attempt.generation, model),) if attempt.generation else ()
    given = None if asked else {"prompt": attempt.prompt}
    gave = {"verdict": step.state} if asked else {"answer": attempt.answer, "verdict": step.state}
    return Span(step, inputs=given, outputs=gave, findings=attempt.findings, children=asked)


def _answer(step: Step, attempt: Attempt, generation: Mapping[str, Any], model: str) -> Span:
    """The model's part of an attempt: it comes first, then code draws and validators judge."""
    ended = min(step.ended_s, step.began_s + float(generation.get("seconds") or 0.0))
    about = {name: value for name, value in generation.items() if name not in ("prompt_tokens", "answer_tokens")}
    return Span(
        Step(model or "model", step.began_s, ended),
        MODEL,
        {"messages": [{"role": "user", "content": attempt.prompt}]},
        {"choices": [{"message": {"role": "assistant", "content": attempt.answer}}]},
        about,
        (int(generation.get("prompt_tokens") or 0), int(generation.get("answer_tokens") or 0)),
    )


def _gave(name: str, result: Mapping[str, Any], metrics: Mapping[str, Any]) -> Any:
    """What a stage gave, as far as the case's files say it."""
    match name:
        case "read":
            return {fact["field"]: fact["value"] for fact in result.get("facts") or ()} or None
        case "road":
            return result.get("network")
        case "scenario":
            return {"actors": result["actors"]} if result.get("actors") else None
        case "simulate":
            return {"contact": (result.get("collision") or {}).get("observed")}
        case "measure":
            return {key: metrics[key] for key in ("exact", "paper") if key in metrics} or None
        case "judge" | "drive":
            return result.get("judge") if name == "judge" else metrics.get("drive")
        case _:
            return None
