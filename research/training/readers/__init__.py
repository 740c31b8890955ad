"""Trainers of the linear second readers. Know no network."""
