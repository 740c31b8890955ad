"""A reading as a road layout: told lanes, legs and control, and defaults for what is open."""
