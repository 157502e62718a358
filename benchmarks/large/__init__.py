"""sgi and its peers on pictures of many megapixels."""
