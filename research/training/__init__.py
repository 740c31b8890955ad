"""Trainers of the embedded model and of the learned reader."""
