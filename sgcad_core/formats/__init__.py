"""Standards on one side, records on the other: SUMO XML, OpenDRIVE, OpenSCENARIO."""
