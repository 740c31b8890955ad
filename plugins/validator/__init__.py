"""Validators: from a network or a scenario to findings. One file for each plugin."""
