"""Batches of cases: planned, run under Prefect, tracked, summarized."""
