"""Rate, distortion and time of sgi against other codecs, on the same pictures with the same measures.

The modules from the bottom up: `bdrate` (curves), `codec` (what a codec must offer), `peers`, `published` and
`sgi` (the codecs), `rows` (results on disk), `measures` (what is compared), `run` (the measurement), `lossless` (that
of exact samples), `summary`, `tables` and `plots` (what follows from the rows), `command` (the command line). scipy,
ssimulacra2, pillow, imagecodecs and matplotlib come with the extra `sgicodec[bench]`.
"""
