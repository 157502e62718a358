"""From what was asked for to λ: targets, R-D models, searches. Pure functions of numbers."""
