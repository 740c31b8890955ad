"""Many cases: planned, run under Prefect, tracked, summarised."""
