"""The package's version, once."""

__version__ = "1.0.0"
