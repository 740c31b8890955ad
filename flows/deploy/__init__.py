"""What a schedule starts: inbox, nightly, study, evaluate, reindex. deploy/prefect.yaml serves these flows."""
