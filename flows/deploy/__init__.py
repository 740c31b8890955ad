"""What a schedule starts: inbox, nightly, study, reindex. deploy/prefect.yaml serves these flows."""
