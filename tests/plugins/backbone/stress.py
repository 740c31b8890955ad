"""Random schemas, prompts and decoders through the loop: valid JSON or a named field, never a stall.

    python -m tests.plugins.backbone.stress 10000 [first seed]

The default of the test is smaller. Schemas nest objects, lists, choices, numbers with and without bounds,
strings with lengths or patterns; some cannot be met, and some answers cannot fit in their token limit.
"""

from __future__ import annotations

import json
import random
import re
import sys
from collections import Counter
from typing import Any

from plugins.backbone.engine.faults import DoesNotFit
from plugins.backbone.engine.grammar import Grammar, GrammarCompiler
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Prompt, Request
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.nucleus import Nucleus
from plugins.decoder.plausible import Plausible
from tests.plugins.backbone import tiny

STALL_S = 900.0
_EXPECTED = re.compile(r"not finished after|is an end token of this tokenizer")
PATTERNS = (r"^[A-Za-z][A-Za-z0-9_]{0,23}$", r"^[VPBTO][0-9]{1,2}$", r"^(N|S)(E|W)?$", r"^[0-9]{4}-[0-9]{2}$")
WORDS = (
    "left", "right", "through", "none", "signal", "ünïcode", 'quo"te', "back\\slash", "N", "NE", "", "a b", "<eos>x"
)  # fmt: skip
DECODERS = (
    Greedy(), Cad(), Cad(alpha=2.0), Cad(beta=0.3), Nucleus(temperature=1.5), AdaCad(), Plausible(beta=0.5),
    Cad(temperature=1.0),
)  # fmt: skip


def schema(rng: random.Random, depth: int = 0) -> dict[str, Any]:
    """A random schema; about one in fifty cannot be met."""
    kinds = ["integer", "number", "string", "enum", "boolean", "null", "const", "anyOf"]
    kinds += ["object", "array"] * 3 if depth < 3 else []
    kind = rng.choice(kinds) if depth else "object"
    made: dict[str, Any] = {"type": kind}
    if kind == "object":
        names = rng.sample(["id", "legs", "lanes_in", "x_m", "kind", "ünder", "a b", "note"], rng.randint(1, 4))
        fields = {name: schema(rng, depth + 1) for name in names}
        made |= {"properties": fields, "required": names if rng.random() < 0.8 else names[:1]}
        made["additionalProperties"] = False
    elif kind == "array":
        low = rng.randint(0, 2)
        high = low - 1 if low and _one_in(rng, 15) else low + rng.randint(0, 3)
        made |= {"items": schema(rng, depth + 1), "minItems": low, "maxItems": high}
    elif kind in ("integer", "number"):
        made |= _bounds(rng, kind)
    elif kind == "string":
        made |= _string(rng)
    elif kind == "enum":
        made = {"enum": rng.sample(WORDS, rng.randint(1, 5))}
    elif kind == "const":
        made = {"const": rng.choice([1, -2, "N", True, None, {"a": 1}, [1, "x"]])}
    elif kind == "anyOf":
        made = {"anyOf": [schema(rng, depth + 2) for _ in range(rng.randint(2, 3))]}
    return made


def _one_in(rng: random.Random, count: int) -> bool:
    return rng.randrange(count) == 0


def _bounds(rng: random.Random, kind: str) -> dict[str, Any]:
    low = rng.randint(-3000, 3000)
    high = low + rng.choice([0, 1, 8, 120, 6000]) - (9 if _one_in(rng, 40) else 0)
    return rng.choice([{}, {"minimum": low, "maximum": high}, {"minimum": low}, {"maximum": high}])


def _string(rng: random.Random) -> dict[str, Any]:
    if rng.random() < 0.3:
        return {"pattern": rng.choice(PATTERNS)}
    low = rng.choice([0, 0, 1, 5, 90])
    return rng.choice([{}, {"maxLength": low + 5}, {"minLength": low, "maxLength": low + 10}, {"minLength": low}])


def faults(value: Any, wanted: dict[str, Any]) -> list[str]:
    """What is wrong with a value, by a validator written for this test."""
    if "anyOf" in wanted:
        return [] if any(not faults(value, part) for part in wanted["anyOf"]) else [f"{value!r} meets no branch"]
    if "const" in wanted:
        same = value == wanted["const"] and type(value) is type(wanted["const"])
        return [] if same else [f"{value!r} is not the const"]
    if "enum" in wanted:
        return [] if value in wanted["enum"] else [f"{value!r} is not in the enum"]
    if not _is(value, wanted["type"]):
        return [f"{value!r} is no {wanted['type']}"]
    return _KINDS.get(wanted["type"], lambda v, w: [])(value, wanted)


def _is(value: Any, kind: str) -> bool:
    if kind in ("integer", "number"):
        return not isinstance(value, bool) and isinstance(value, int if kind == "integer" else (int, float))
    return isinstance(value, {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}[kind])


def _object_faults(value: dict[str, Any], wanted: dict[str, Any]) -> list[str]:
    order = [name for name in wanted["properties"] if name in value]
    found = [f"missing {name}" for name in wanted["required"] if name not in value]
    found += ["keys out of order or unknown"] if list(value) != order else []
    return found + [f for name in order for f in faults(value[name], wanted["properties"][name])]


def _array_faults(value: list[Any], wanted: dict[str, Any]) -> list[str]:
    found = [] if wanted["minItems"] <= len(value) <= wanted["maxItems"] else [f"{len(value)} items"]
    return found + [f for item in value for f in faults(item, wanted["items"])]


def _number_faults(value: float, wanted: dict[str, Any]) -> list[str]:
    inside = wanted.get("minimum", value) <= value <= wanted.get("maximum", value)
    return [] if inside else [f"{value} is out of range"]


def _string_faults(value: str, wanted: dict[str, Any]) -> list[str]:
    if "pattern" in wanted and not re.search(wanted["pattern"], value):
        return [f"{value!r} does not match"]
    inside = wanted.get("minLength", 0) <= len(value) <= wanted.get("maxLength", len(value))
    return [] if inside else [f"length {len(value)}"]


_KINDS: dict[str, Any] = {
    "object": _object_faults, "array": _array_faults, "integer": _number_faults, "number": _number_faults,
    "string": _string_faults,
}  # fmt: skip


def request(maker: GrammarCompiler, wanted: dict[str, Any], rng: random.Random) -> tuple[Request, Grammar]:
    """A random prompt, decoder, draft and limit for a schema. Raises DoesNotFit if nothing can meet it."""
    grammar = maker.grammar(wanted)
    decoder = rng.choice(DECODERS)
    shared = tiny.words(rng.randint(1, 20), rng.randrange(40))
    with_ = Prompt([*shared, *tiny.words(rng.randint(0, 40), rng.randrange(10**6)), 9])
    without = Prompt([*shared, 9]) if decoder.reads_prior() or rng.random() < 0.3 else None
    draft = tiny.words(rng.randint(0, 30), rng.randrange(10**6)) if _one_in(rng, 4) else ()
    limit = rng.choice([8, 40, 200, 200])
    made = Request(
        with_, without, decoder, grammar, rng.randrange(99), limit, frozenset({2}), draft, rng.random() < 0.8
    )  # fmt: skip
    return made, grammar


def stress(count: int, first_seed: int = 0) -> tuple[Counter[str], list[str]]:
    """Run `count` random cases, 16 at once: how they ended, and every broken promise."""
    model, family = tiny.build("text_only")
    maker = GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2])
    engine = engine_of(model, family, reports_at_once=16)
    ends: Counter[str] = Counter()
    broken: list[str] = []
    for start in range(first_seed, first_seed + count, 64):
        waiting = []
        for seed in range(start, min(start + 64, first_seed + count)):
            rng = random.Random(seed)
            wanted = schema(rng)
            try:
                made, grammar = request(maker, wanted, rng)
                waiting.append((seed, wanted, grammar, engine.submit(made)))
            except DoesNotFit as fault:
                ends["schema cannot be met"] += 1
                broken += [] if fault.path else [f"seed {seed}: no path: {fault}"]
        for seed, wanted, grammar, future in waiting:
            try:
                answer = future.result(timeout=STALL_S)
            except DoesNotFit as fault:
                ends["did not fit"] += 1
                broken += [] if fault.path and _EXPECTED.search(str(fault)) else [f"seed {seed}: {fault.path}: {fault}"]
                continue
            ends["valid"] += 1
            broken += [f"seed {seed}: {f}" for f in _checked(grammar.text(answer.ids), wanted)]
    engine.close()
    return ends, broken


def _checked(text: str, wanted: dict[str, Any]) -> list[str]:
    try:
        return faults(json.loads(text), wanted)
    except ValueError as fault:
        return [f"no JSON: {fault}: {text[:80]!r}"]


if __name__ == "__main__":
    ended, wrong = stress(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    sys.stdout.write(f"{dict(ended)}; broken promises: {len(wrong)}\n" + "".join(f"  {w}\n" for w in wrong[:20]))
    sys.exit(bool(wrong))
