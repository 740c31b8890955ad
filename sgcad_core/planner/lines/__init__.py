"""The lines that actors follow: routes over lanes, and smooth paths on them."""
