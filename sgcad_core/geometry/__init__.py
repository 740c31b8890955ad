"""Plane geometry: oriented boxes, polylines and distances. Metres and radians; knows no format."""
