"""Finished cases in the formats of other tools, and as films."""
