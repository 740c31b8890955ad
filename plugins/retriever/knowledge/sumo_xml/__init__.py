"""SUMO's plain-XML elements and attributes as chunks."""
