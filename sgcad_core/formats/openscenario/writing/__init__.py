"""Plans written as OpenSCENARIO: timed polylines, maneuver events, logical scenarios."""
