"""What a stream means: the mathematics of the model, without I/O."""
