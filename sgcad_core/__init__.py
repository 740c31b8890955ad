"""What things are: records, interfaces, formats, metrics. Knows no Prefect, MLflow or torch."""
