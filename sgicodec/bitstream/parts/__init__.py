"""The parts of a tile: base layer, positions, networks, attributes, mask."""
