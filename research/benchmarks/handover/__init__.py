"""Benchmarks of files in which one vehicle waits for its driver."""
