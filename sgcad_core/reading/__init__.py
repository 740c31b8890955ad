"""Facts that rules can read off a crash narrative. Knows no model and no file format."""
