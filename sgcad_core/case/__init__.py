"""The frozen records that one case hands from stage to stage: report, evidence, network, scenario, execution."""
