"""A tile as Python has it: its model, its chunk, its mask, priors."""
