"""What every record of the project is: frozen, closed, compared by value. Knows nothing else of the project."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

Value = str | int | float | bool | tuple[str, ...] | None
"""What a fact, an edit or an answer may say of one field."""


class Record(BaseModel):
    """Frozen, closed, compared by value."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)
