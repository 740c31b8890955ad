"""What is wrong with an OpenDRIVE file, and an index of its roads and lanes."""
