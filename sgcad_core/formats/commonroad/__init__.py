"""CommonRoad XML: a crash as a planning problem for the ego."""
