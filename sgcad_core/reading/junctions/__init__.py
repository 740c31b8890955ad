"""Junctions: kind, legs, control, and the lanes of every approach."""
