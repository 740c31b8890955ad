"""Road writers: from evidence to a road network. One file for each plugin."""
