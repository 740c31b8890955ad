"""Training rows: reports as tokens, with labels."""
