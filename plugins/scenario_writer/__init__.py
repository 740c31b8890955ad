"""Evidence and network -> Scenario. One file per choice."""
