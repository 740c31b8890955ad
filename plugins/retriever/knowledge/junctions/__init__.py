"""Real junctions of OpenStreetMap extracts as chunks."""
