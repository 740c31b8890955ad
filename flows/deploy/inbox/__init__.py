"""The inbox deployment: ready reports, claims of workers, finished reports."""
