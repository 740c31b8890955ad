"""Vehicles, pedestrians, cyclists and drivers of a report, and the words that refer to them."""
