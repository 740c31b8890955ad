"""Benchmarks of cost: stages, batches, services, several machines."""
