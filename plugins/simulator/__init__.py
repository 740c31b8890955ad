"""Scenario -> Execution. One file per choice."""
