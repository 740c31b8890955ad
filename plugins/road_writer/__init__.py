"""Evidence -> RoadNetwork. One file per choice."""
