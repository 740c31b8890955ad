"""Running it for good: services on this machine (local), in containers (compose.yaml), and their checks."""
