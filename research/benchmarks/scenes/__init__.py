"""Benchmarks of roads, plans and players."""
