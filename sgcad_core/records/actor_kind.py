"""The kind of an actor as specs and results hold it: the id of one of the records in `sgcad_core.kinds`.

Not a Literal: ids stand in the records alone. A schema that the embedded model is asked with keeps what it learned.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from sgcad_core.kinds import ACTORS, learned_actors
from sgcad_core.records.answer_schema import TRAINED


def _known(kind: str) -> str:
    """A kind that there is, else pydantic's error for a wrong literal."""
    if kind in ACTORS:
        return kind
    names = [repr(name) for name in ACTORS]
    expected = f"{', '.join(names[:-1])} or {names[-1]}"
    raise PydanticCustomError("literal_error", "Input should be {expected}", {"expected": expected})


class _OfRecords:
    """Checks an id against the records, and writes them into JSON schemas."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_after_validator_function(_known, core_schema.str_schema())

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"enum": list(ACTORS), "type": "string", TRAINED: {"enum": list(learned_actors())}}


ActorKind = Annotated[str, _OfRecords]
"""An id of `sgcad_core.kinds.ACTORS`."""
