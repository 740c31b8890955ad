"""OpenStreetMap extracts: read, searched for streets and junctions by name, told as legs with lanes and control."""
