"""Pictures in and out of files. The only user of OpenImageIO.

    picture = read("in.tif")
    unit = to_unit(picture)                                  # float32 [H, W, C] in 0..1
    again = from_unit(unit, picture.channels, picture.pixels.dtype, picture.sample_range, picture.metadata)
    write(again, "out.png")

Pictures that need not fit into memory come and go in parts, and may be larger than `read` takes:

    with open_source("in.tif") as source, open_sink("out.tif", source.width, 512, "rgb", "uint8") as sink:
        sink.write_rows(0, source.read(0, 1000, source.width, 512).pixels)

docs/pictures.md says what happens to each kind of input. OpenImageIO loads with the first file that needs it.
"""
