"""Byte formats of what travels with a picture: EXIF, XMP, ICC, and the tags that place it on the earth."""
