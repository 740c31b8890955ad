"""What PyYAML raises for a text that is no YAML, beside its own errors: odd dates and numbers, depth."""

from __future__ import annotations

import yaml

YAML_FAULTS = (
    yaml.YAMLError, ValueError, LookupError, AttributeError, TypeError, OverflowError, RecursionError, MemoryError,
)  # fmt: skip
