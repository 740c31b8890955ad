"""Runnable snippets on scenariogeneration, and how they become chunks."""
