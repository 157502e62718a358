"""Streams in other libraries: one module for each, which imports its library. docs/plugins.md shows their use."""
