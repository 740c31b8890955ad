"""Simulators: from a scenario to its execution. One file for each plugin."""
