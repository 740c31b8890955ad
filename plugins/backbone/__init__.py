"""Prompt -> tokens: owns the model, the token loop and its caches. One file per choice."""
