"""Streams to pixels: any region at any scale. Needs numpy and the extension alone."""
