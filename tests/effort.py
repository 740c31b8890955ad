"""How many examples a costly test draws: few in every run of the suite, many in `make test-thorough`."""

import os

THOROUGH = os.environ.get("SGCAD_THOROUGH") == "1"


def many(usual: int, thorough: int) -> int:
    """The count for this run: as many as find what breaks, or as many as find what is rare."""
    return thorough if THOROUGH else usual
