"""From what was asked for to a quality: targets, and the search. Pure functions of numbers."""
