"""Logit rows -> the row to pick from: pure functions. One file per choice."""
