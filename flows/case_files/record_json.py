"""Records as JSON and back, for stages shared between configs and processes; the JSON holds no code.

A packed value names its records by class, out of a closed list, and every record is validated when it is read: a
file written into a shared folder by others can spoil a result there, but never run code. Arrays of numbers and bytes
are base64. Knows records, specs and the turns of refinement; no file and no plugin.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from sgcad_core.asking.refine import Call, Turn
from sgcad_core.case import records
from sgcad_core.errors import Refused
from sgcad_core.records import specs

KIND = "~"
"""The key under which a JSON object says what it stands for."""
MAX_BYTES = 256_000_000
"""Of one unpacked value: a case's trajectories and pictures are some hundred times smaller."""


class Unpackable(ValueError):
    """Bytes that are no packed value of these records."""


def pack(value: Any) -> bytes:
    """A value of records, containers, arrays and plain values, compressed. Raises TypeError for anything else."""
    return zlib.compress(json.dumps(_plain(value), separators=(",", ":")).encode(), 1)


def unpack(packed: bytes) -> Any:
    """The value again, validated record by record. Raises Unpackable."""
    stream = zlib.decompressobj()
    try:
        text = stream.decompress(packed, MAX_BYTES)
        if stream.unconsumed_tail or not stream.eof:
            raise Unpackable(f"more than {MAX_BYTES} bytes, or cut short")
        return _value(json.loads(text))
    except (zlib.error, ValidationError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as fault:
        raise Unpackable(f"not a packed value of these records: {fault}") from fault


@cache
def _models() -> Mapping[str, type[BaseModel]]:
    found = [item for module in (records, specs) for item in vars(module).values()]
    return {item.__name__: item for item in found if isinstance(item, type) and issubclass(item, BaseModel)}


class _TurnFields(records.Record):
    """Fields of a Turn."""

    attempt: records.Attempt
    artifact: records.RoadNetwork | records.Scenario | None
    refused: Refused | None
    calls: tuple[Call, ...]


class _CallFields(records.Record):
    """Fields of a Call."""

    query: records.Query
    generation: records.Generation


_CHECKED: Mapping[str, tuple[type[Turn | Call], type[BaseModel]]] = {
    "Turn": (Turn, _TurnFields),
    "Call": (Call, _CallFields),
}
"""Dataclasses that are packed, and the model that checks their fields."""


def _plain(value: Any) -> Any:
    """The value in JSON's terms."""
    if value is None or isinstance(value, str | int | float):
        return value
    if isinstance(value, Mapping):
        return {KIND: "dict", "items": [[_plain(k), _plain(v)] for k, v in value.items()]}
    if isinstance(value, list | tuple):
        return {KIND: type(value).__name__, "items": [_plain(item) for item in value]}
    if isinstance(value, bytes):
        return {KIND: "bytes", "data": base64.b64encode(value).decode()}
    if isinstance(value, np.ndarray):
        numbers = np.ascontiguousarray(value, dtype="<f8")
        return {KIND: "array", "shape": list(numbers.shape), "data": base64.b64encode(numbers.tobytes()).decode()}
    if isinstance(value, Refused):
        return {KIND: "Refused", "reason": value.reason, "missing": list(value.missing)}
    return {KIND: _kind(value), "fields": {name: _plain(getattr(value, name)) for name in _fields(value)}}


def _kind(value: Any) -> str:
    name = type(value).__name__
    if type(value) not in (_models().get(name), *(made for made, _ in _CHECKED.values())):
        raise TypeError(f"a {type(value).__qualname__} cannot be packed: only the project's own records are")
    return name


def _fields(value: Any) -> list[str]:
    return list(type(value).model_fields) if isinstance(value, BaseModel) else [f.name for f in fields(value)]


def _value(told: Any) -> Any:
    """The value that JSON stands for."""
    if not isinstance(told, dict):
        if isinstance(told, list):
            raise Unpackable("a bare list")
        return told
    kind = told[KIND]
    if read := _CONTAINERS.get(kind):
        return read(told)
    content = {str(name): _value(inner) for name, inner in told["fields"].items()}
    if kind in _CHECKED:
        made, check = _CHECKED[kind]
        return made(**dict(check.model_validate(content)))
    return _models()[kind].model_validate(content)


def _array(told: Mapping[str, Any]) -> np.ndarray[Any, np.dtype[np.float64]]:
    numbers = np.frombuffer(base64.b64decode(told["data"], validate=True), dtype="<f8")
    return numbers.reshape([int(n) for n in told["shape"]]).astype(np.float64)


_CONTAINERS: Mapping[str, Callable[[Mapping[str, Any]], Any]] = {
    "dict": lambda told: {_value(key): _value(value) for key, value in told["items"]},
    "list": lambda told: [_value(item) for item in told["items"]],
    "tuple": lambda told: tuple(_value(item) for item in told["items"]),
    "bytes": lambda told: base64.b64decode(told["data"], validate=True),
    "array": _array,
    "Refused": lambda told: Refused(str(told["reason"]), [str(name) for name in told["missing"]]),
}
