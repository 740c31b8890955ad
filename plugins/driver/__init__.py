"""Drivers of the ego after the hand-over of a reconstructed crash. One file for each plugin."""
