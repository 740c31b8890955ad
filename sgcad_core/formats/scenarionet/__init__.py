"""ScenarioNet records, which MetaDrive and ScenarioNet read: one dictionary a scenario, pickled."""
