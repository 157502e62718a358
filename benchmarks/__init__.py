"""Everything that measures and is no part of the package: `python -m benchmarks.NAME --help` in the repository."""
