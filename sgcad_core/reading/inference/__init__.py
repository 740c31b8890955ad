"""What follows from what is told, what is missing, and other readings of the same text."""
