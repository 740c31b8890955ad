-- Run once, when the database volume is new: MLflow's database beside Prefect's.
CREATE DATABASE mlflow;
