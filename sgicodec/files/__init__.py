"""Files that appear whole or not at all, unfinished ones, and locks on them."""
