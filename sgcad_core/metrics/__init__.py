"""Pure functions on records: what a network, an execution or a batch of cases is worth."""

from sgcad_core.metrics.measure import measure
from sgcad_core.metrics.thresholds import Thresholds

__all__ = ["Thresholds", "measure"]
