"""Cases that run in a Dask cluster, on this machine or on others (docs/scale.md)."""
