"""What decoding costs: arms in turn, and contrast through a real server."""
