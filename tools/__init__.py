"""Programs that made the data that the package ships: frequency tables and priors."""
