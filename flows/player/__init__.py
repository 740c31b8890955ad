"""The player page and the overview picture of a case, and any scenario file in the player."""
