"""Benchmarks of reading: what share of reports is read right."""
