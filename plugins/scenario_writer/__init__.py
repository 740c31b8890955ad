"""Scenario writers: from evidence and a road network to a scenario. One file for each plugin."""
