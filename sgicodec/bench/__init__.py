"""Rate, distortion and time of sgi against other codecs, on the same pictures with the same measures.

The modules from the bottom up: `pchip` and `bdrate` (curves), `codec` (what a codec must offer), `peers`
and `sgi` (the codecs), `rows` (results on disk), `run` (the measurement), `summary` and `plots` (what
follows from the rows), `command` (the command line). Pillow, imagecodecs and matplotlib come with the extra
`sgicodec[bench]` and are imported only where they are used.
"""
