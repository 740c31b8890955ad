"""The base of all specs that a model answers in, and their JSON schemas as the embedded model learned them.

Specs grow: fields are `added`, others are marked with what they were (`TRAINED`). A model whose weights know the former
schema is asked for that one, since another word in its prompt is one that it has never seen. Knows pydantic only.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer

ADDED = "x-added"
"""Mark of a field that came after the embedded model was trained: `trained_schema` is without it."""
TRAINED = "x-trained"
"""Mark of a field that has changed since the embedded model was trained: what `trained_schema` has in its place."""
_REFERS = "#/$defs/"


def added(default: Any, description: str) -> Any:
    """A field that answers may leave out, of places that not every model knows; old specs stay valid."""
    return Field(default, description=description, json_schema_extra={ADDED: True})


class Spec(BaseModel):
    """A frozen answer: unknown keys are faults. Fields that were `added` are written only where they say something."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_serializer(mode="wrap")
    def _written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = handler(self)
        defaults = {name: type(self).model_fields[name].default for name in added_fields(type(self))}
        return {name: v for name, v in fields.items() if name not in defaults or getattr(self, name) != defaults[name]}


def added_fields(model: type[Spec]) -> tuple[str, ...]:
    """Names of a spec's fields that came after the embedded model was trained."""
    marks = {name: field.json_schema_extra for name, field in model.model_fields.items()}
    return tuple(name for name, extra in marks.items() if isinstance(extra, dict) and ADDED in extra)


def trained_schema(model: type[Spec]) -> dict[str, Any]:
    """The JSON schema of a spec as it was: without what was added to it, to the specs in it, and by those alone."""
    schema: dict[str, Any] = _as_trained(model.model_json_schema())
    defs = schema.pop("$defs", None)
    if defs is None:
        return schema
    used, reached = set(_references(schema)), set[str]()
    while used - reached:
        reached |= used
        used |= {name for known in reached for name in _references(defs[known])}
    return {"$defs": {name: part for name, part in defs.items() if name in used}, **schema}


def _references(schema: Any) -> Iterator[str]:
    """Names of the definitions that a schema refers to."""
    if isinstance(schema, list):
        for part in schema:
            yield from _references(part)
    if isinstance(schema, dict):
        if "$ref" in schema:
            yield schema["$ref"].removeprefix(_REFERS)
        for part in schema.values():
            yield from _references(part)


def _as_trained(schema: Any) -> Any:
    if isinstance(schema, list):
        return [_as_trained(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    schema = {**schema, **schema.get(TRAINED, {})}
    added_since = {key for key, part in schema.items() if isinstance(part, dict) and ADDED in part}
    return {key: _as_trained(part) for key, part in schema.items() if key not in (TRAINED, *added_since)}
