"""Traffic rules: what is broken, kept or unknown."""
