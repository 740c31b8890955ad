"""CommonRoad XML: a planning problem of a crash, written by the format's own library (the extra `commonroad`)."""
