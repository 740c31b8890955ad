"""OpenDRIVE: reference lines, lanes, connectors, and what is wrong with a file."""
