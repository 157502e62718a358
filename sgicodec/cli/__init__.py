"""The command line `sgi`, one file per command (docs/cli.md).

Modules of this package import nothing heavy at their top, so that `sgi info` starts at once.
"""
