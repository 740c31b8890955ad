"""An OpenDRIVE network as the player drives it: geometry, links, routes, lane motion."""
