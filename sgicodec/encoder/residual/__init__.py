"""What a residual layer shows of a picture and what tiles do, and the bytes of the layer."""
