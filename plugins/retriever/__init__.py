"""Retrievers: from a text to passages. One file for each plugin."""
