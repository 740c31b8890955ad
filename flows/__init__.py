"""In what order things happen: one case, a batch, the command line. The only package that imports Prefect."""
