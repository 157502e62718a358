"""What an encode reads: a picture in windows, what of it holds nothing, and its overview."""
