"""The profiles of the codec: what differs from one to the next, in one file each."""
