"""The architecture of the embedded model, its tokens and its answers."""
