"""Servers as backbones: their protocols, drafts and values."""
