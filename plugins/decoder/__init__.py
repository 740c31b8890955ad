"""Decoders: pure functions from two rows of logits to the row that tokens are picked from. One file for each plugin."""
