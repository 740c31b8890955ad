"""Who struck whom, where and in which order; near crashes; what happened after the first contact."""
