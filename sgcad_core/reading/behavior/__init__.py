"""A reading as a behavior on a road network: a road, a lane and an exit for every actor."""
