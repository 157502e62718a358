"""From what was asked for to λ: targets, R-D models, controllers. Pure functions of numbers."""
