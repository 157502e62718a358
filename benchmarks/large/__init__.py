"""sgi and its peers on pictures of many megapixels: `python -m benchmarks.large PICTURE…`."""
