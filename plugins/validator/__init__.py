"""An artifact -> findings. One file per choice."""
