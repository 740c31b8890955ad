"""Who is in a report: vehicles, pedestrians, cyclists, drivers, and the words that refer to them."""
