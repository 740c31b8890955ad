"""The page of a study and its figures: plots, scenes, drives, the case gallery."""
