"""A scenario as it is played: its parts, its playback and its first contact."""
