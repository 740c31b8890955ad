"""The forms in which a scenario can be written. Apart from the writer, whose library takes half a second to import."""

from __future__ import annotations

from typing import Literal

Version = Literal["1.0", "1.1", "1.2", "1.3"]
VERSIONS: tuple[Version, ...] = ("1.0", "1.1", "1.2", "1.3")
DEFAULT_VERSION: Version = "1.2"
Encoding = Literal["timed", "events"]
DEFAULT_ENCODING: Encoding = "timed"
