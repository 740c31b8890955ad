"""Trackers: log cases where they can be compared. One file for each plugin."""
