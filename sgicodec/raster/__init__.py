"""Gaussians to pixels: `native` draws, `reference` defines what is drawn."""
