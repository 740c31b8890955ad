"""Hostile input by the thousand, one module a kind: `python -m research.benchmarks.attack`."""
