"""Road-network errors against a ground truth: counts in, fractions out.

Two figures each: the error of the paper's formula (mean over reports) and whether there is any error
(share of reports; the published tables appear to be this one). Knows no file format.
"""

from __future__ import annotations


def relative_error(truth: float, made: float) -> float:
    """1 - max(0, 1 - |truth - made| / truth), in [0, 1]; a truth of 0 is divided by 1 (the paper leaves 0/0 open)."""
    return min(1.0, abs(truth - made) / (truth or 1.0))


def any_error(error: float) -> float:
    """1 if a report has any error, else 0: its mean over reports is the share with an error."""
    return float(error > 1e-6)
