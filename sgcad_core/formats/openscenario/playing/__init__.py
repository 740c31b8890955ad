"""Scenario files played: entities, storyboard, positions, distances, signals."""
