"""One tile on its way to a stream: its state, the stages, and the two strategies of texture."""
