"""Where the work on tiles runs: this process, several, or the workers of a Dask cluster."""
