"""Figures of a study: plots, scenes, the case gallery."""
