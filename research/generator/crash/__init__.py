"""Made crashes: roads, actors, motion, impacts."""
