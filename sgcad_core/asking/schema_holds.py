"""An answer's JSON schema narrowed by the findings of validators.

A model too small to use findings would repeat a fault by chance; a decoder under a narrowed grammar cannot repeat the
fault. What findings leave open is still the model's. Knows schemas and holds; no validator, no model.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from sgcad_core.case.records import Hold

Json = dict[str, Any]
Allowed = Mapping[str, Sequence[str | int]]

SOME_LANES = tuple(range(1, 9))
"""Lanes one way that a leg of a layout may have, if it has any."""


def narrowed_schema(schema: Mapping[str, Any], holds: Sequence[Hold]) -> Json:
    """The schema with every hold that it can meet; others, and lists that it does not have, are passed over.

    Branches of `anyOf` are narrowed each, so that a refusal stays a way out.
    """
    if "anyOf" in schema:
        return {**schema, "anyOf": [narrowed_schema(branch, holds) for branch in schema["anyOf"]]}
    fields = dict(schema.get("properties") or {})
    for hold in holds:
        if fields.get(hold.items, {}).get("type") == "array":
            fields[hold.items] = _held(fields[hold.items], hold)
    return {**schema, "properties": fields} if fields else dict(schema)


def _held(array: Json, hold: Hold) -> Json:
    if hold.at is not None and hold.at >= array.get("maxItems", hold.at + 1):
        return array
    most = array.get("maxItems", hold.at_least)
    out = {**array, "minItems": max(array.get("minItems", 0), min(hold.at_least, most))}
    if hold.at_most is not None and hold.at_most >= out["minItems"]:
        out["maxItems"] = min(hold.at_most, array.get("maxItems", hold.at_most))
    if not hold.either:
        return out
    places = [*out.get("prefixItems", ()), out["items"]]
    if hold.at is None:
        changed = [_chosen(place, hold) or place for place in places]
    else:
        places += [out["items"]] * (hold.at + 2 - len(places))
        changed = [_chosen(place, hold) or place if i == hold.at else place for i, place in enumerate(places)]
    if changed == places:
        return array
    if hold.at is not None:
        out["minItems"] = max(out["minItems"], hold.at + 1)
    prefix = {"prefixItems": changed[:-1]} if len(changed) > 1 else {}
    return {**out, **prefix, "items": changed[-1]}


def _chosen(place: Json, hold: Hold) -> Json | None:
    """What an item may be under a hold; None where the hold has nothing to say or leaves nothing to be said."""
    variants = list(place["anyOf"]) if "anyOf" in place else [place]
    meant = _each(variants, ({hold.key: hold.values},)) if hold.key else variants
    rest = [item for v in variants for item in _each([v], ({hold.key: _others(v, hold)},))] if hold.key else []
    held = _each(meant, hold.either)
    if not held:
        return None
    found = [*held, *rest]
    return found[0] if len(found) == 1 else {"anyOf": found}


def _each(items: Sequence[Json], either: Sequence[Allowed]) -> list[Json]:
    """Every item under every choice that it can make."""
    found = (_with(item, choice) for item in items for choice in either)
    return [item for item in found if item is not None]


def _others(item: Json, hold: Hold) -> Sequence[str]:
    """Values that the key may have in items that are not meant."""
    listed = _listed(item["properties"].get(hold.key, {}))
    return [value for value in (hold.others if listed is None else listed) if value not in hold.values]


def _with(item: Json, choice: Allowed) -> Json | None:
    """An item whose fields say only what is allowed; None if a field is missing or has nothing left to say."""
    fields = dict(item["properties"])
    for name, values in choice.items():
        kept = [value for value in values if name in fields and _may_be(fields[name], value)]
        if not kept:
            return None
        fields[name] = {"type": "integer" if isinstance(kept[0], int) else "string", "enum": kept}
    return {**item, "properties": fields}


def _listed(schema: Json) -> list[Any] | None:
    """The values that a schema lists; None where it does not."""
    return list(schema["enum"]) if "enum" in schema else None


def _may_be(schema: Json, value: str | int) -> bool:
    if "anyOf" in schema:
        return any(_may_be(branch, value) for branch in schema["anyOf"])
    if (listed := _listed(schema)) is not None:
        return value in listed
    if isinstance(value, int):
        return schema.get("type") == "integer" and schema.get("minimum", value) <= value <= schema.get("maximum", value)
    pattern = schema.get("pattern", "")
    return schema.get("type") == "string" and (not pattern or re.search(pattern, value) is not None)
