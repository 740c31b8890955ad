"""Kinds of attack that run whole commands: kills, many cases, disasters, the default config."""
