"""The file: container, entropy coding and the coders of a tile's parts. See docs/format.md."""
