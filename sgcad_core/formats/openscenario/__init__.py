"""OpenSCENARIO XML: written, read, checked and played."""
