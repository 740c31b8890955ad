"""What happened -> a place where it can be compared. One file per choice."""
