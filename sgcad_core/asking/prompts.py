"""Prompt texts, answer schemas and the way back from a model's text to a spec.

Prompts are data (configs/prompts/*.md with {slots}); this module fills them, writes the strict JSON schema
a grammar or a server enforces, and reads answers. Knows no model, no stage and no file format.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from sgcad_core import settings
from sgcad_core.case.records import Finding
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.records.answer_schema import Spec, trained_schema
from sgcad_core.records.specs import Refusal

Answer = TypeVar("Answer", bound=Spec)
Json = dict[str, Any]

MAX_ITEMS = 16
"""Bound of lists that the spec leaves open: a grammar without one lets a stuck model write forever."""
NUMBER_STEP = 0.01
"""Numbers have at most two decimals, for the same reason."""
MAX_ANSWER = 200_000
_KEPT = (
    "type", "enum", "const", "pattern", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "minLength",
    "maxLength", "minItems", "maxItems", "description",
)  # fmt: skip
_SLOT = re.compile(r"\{([a-z_]+)\}")


# ------------------------------------------------------------------ schema
def answer_schema(
    model: type[Spec], enums: Mapping[str, Sequence[str]] | None = None, refusal: bool = True, places: bool = False
) -> dict[str, Any]:
    """Strict JSON schema of a spec: every key required, in field order, nothing else allowed, no references.

    `enums` narrows string fields by name (`{"road": ["N", "S"]}`, null stays allowed where it was).
    With `refusal` the answer may be a `Refusal` instead. `places`: with the fields of roundabouts and their like, which
    the embedded model has not learned.
    """
    answer = _inlined(model, enums or {}, places)
    return {"anyOf": [answer, _inlined(Refusal, {})]} if refusal else answer


def _inlined(model: type[Spec], enums: Mapping[str, Sequence[str]], places: bool = False) -> Json:
    schema = model.model_json_schema() if places else trained_schema(model)
    return _strict(schema, schema.get("$defs", {}), enums)


def _strict(schema: Json, defs: Json, enums: Mapping[str, Sequence[str]]) -> Json:
    if "$ref" in schema:
        return _strict({**defs[schema["$ref"].rsplit("/", 1)[-1]], **_described(schema)}, defs, enums)
    out = {key: schema[key] for key in _KEPT if key in schema}
    if schema.get("type") == "number":
        out["multipleOf"] = NUMBER_STEP
    if "anyOf" in schema:
        out["anyOf"] = [_strict(branch, defs, enums) for branch in schema["anyOf"]]
    if schema.get("type") == "array":
        out.setdefault("maxItems", MAX_ITEMS)
        out["items"] = _strict(schema.get("items", {}), defs, enums)
    if schema.get("type") == "object":
        fields = {name: _field(name, field, defs, enums) for name, field in schema.get("properties", {}).items()}
        out |= {"properties": fields, "required": list(fields), "additionalProperties": False}
    return out


def _described(schema: Json) -> Json:
    return {"description": schema["description"]} if "description" in schema else {}


def _field(name: str, schema: Json, defs: Json, enums: Mapping[str, Sequence[str]]) -> Json:
    strict = _strict(schema, defs, enums)
    if not enums.get(name):
        return strict
    if "anyOf" in strict:
        return strict | {"anyOf": [_narrowed(branch, enums[name]) for branch in strict["anyOf"]]}
    return _narrowed(strict, enums[name])


def _narrowed(schema: Json, allowed: Sequence[str]) -> Json:
    if schema.get("type") != "string":
        return schema
    return _described(schema) | {"type": "string", "enum": list(dict.fromkeys(allowed))}


# ------------------------------------------------------------------ answer
def parse_answer(text: str, model: type[Answer]) -> Answer:
    """The spec in a model's answer; fences and words around the JSON object are passed over.

    Raises Refused where the model declines, InvalidOutput with one finding a fault (where = JSON path).
    """
    found = _answer_object(text, set(model.model_fields))
    if "refuse" in found and not set(found) & set(model.model_fields):
        raise _refused(found)
    try:
        return model.model_validate(found)
    except ValidationError as fault:
        findings = [_at_fault(error) for error in _root_causes(fault.errors(include_url=False))]
        raise InvalidOutput.of(*findings) from fault


def _answer_object(text: str, fields: set[str]) -> Json:
    """The first JSON object with a key of the answer, else the first object."""
    if len(text) > MAX_ANSWER:
        raise _unreadable(f"the answer has {len(text)} characters, at most {MAX_ANSWER} are read", text)
    objects = list(_objects(text))
    for found in objects:
        if fields & set(found) or "refuse" in found:
            return found
    if objects:
        return objects[0]
    raise _unreadable("the answer holds no complete JSON object", text)


def _objects(text: str, attempts: int = 200) -> Iterator[Json]:
    decoder, at = json.JSONDecoder(), 0
    for _ in range(attempts):
        at = text.find("{", at)
        if at < 0:
            return
        try:
            found, at = decoder.raw_decode(text, at)
            yield found
        except (ValueError, RecursionError):
            at += 1


def _unreadable(what: str, text: str) -> InvalidOutput:
    remedy = "answer with one JSON object of the schema"
    return InvalidOutput.of(Finding(source="answer", what=what, where="$", value=_short(text), remedy=remedy))


def _refused(found: Json) -> Refused:
    missing = found.get("missing")
    return Refused(str(found["refuse"])[:400], [str(m) for m in missing][:12] if isinstance(missing, list) else [])


def _root_causes(errors: list[ErrorDetails]) -> list[ErrorDetails]:
    """Without the "too short" that pydantic adds to a list whose items are at fault."""
    inner = {error["loc"][:n] for error in errors for n in range(len(error["loc"]))}
    return [e for e in errors if not (e["type"] == "too_short" and e["loc"] in inner)]


def _at_fault(error: ErrorDetails) -> Finding:
    remedies = {"missing": "add this key", "extra_forbidden": "leave this key out"}
    missing = error["type"] == "missing"
    return Finding(
        source="answer",
        what="a key is missing" if missing else "not an allowed value" if error["loc"] else error["msg"],
        where=_json_path(error["loc"]),
        value="" if missing else _short(json.dumps(error["input"], default=str)),
        remedy=remedies.get(error["type"], error["msg"]),
    )


def _json_path(loc: Sequence[int | str]) -> str:
    """`("roads", 2, "id")` as `roads[2].id`."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc).lstrip(".") or "$"


def _short(text: str, limit: int = 120) -> str:
    text = " ".join(text.split())
    return text if len(text) <= limit else f"{text[: limit - 3]}..."


# ------------------------------------------------------------------ prompts
def load_prompt(name: str, **slots: str) -> str:
    """configs/prompts/<name>.md with its {slots} filled. Raises ConfigError for an unknown prompt or slot."""
    file = settings.PROMPTS / f"{name}.md"
    if not re.fullmatch(r"[\w-]+", name) or not file.is_file():
        known = ", ".join(sorted(f.stem for f in settings.PROMPTS.glob("*.md")))
        raise ConfigError(f"prompt {name!r}: no such file in {settings.PROMPTS}; there are: {known or 'none'}")
    text = file.read_text(encoding="utf-8")
    wanted = set(_SLOT.findall(text))
    if wanted != set(slots):
        raise ConfigError(
            f"prompt {name!r} ({file}): has slots {sorted(wanted)}, was given {sorted(slots)}; make them the same"
        )
    return _SLOT.sub(lambda match: slots[match[1]], text).strip()
