"""sgi and its peers on pictures of many megapixels: `python -m sgicodec.bench.large PICTURE…`."""
