"""Backbones: from a prompt to tokens, with the model, the token loop and its caches. One file for each plugin."""
