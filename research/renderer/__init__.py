"""Crash diagrams drawn with Pillow in the manner of investigators' drawings; `draw.draw_report` is the way in."""
