"""Programs that measure the package and are no part of it: `python -m benchmarks` in the repository lists them."""
