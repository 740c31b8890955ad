"""A second reader beside the rules (a model, or the one that learned from coded reports), and how both are combined."""
