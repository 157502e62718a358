"""Fixtures of whole programs."""

from gdal_programs import gdal

__all__ = ["gdal"]
