"""Studies: several arms over the same cases, planned before they start, with shared stages computed once."""
