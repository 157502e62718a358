"""Text that is hardly darker than its ground, beside a photograph."""

from __future__ import annotations

import numpy as np
from data_files import crop

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.decoder.stream import open_stream


def test_faint_text_beside_a_photograph_stays() -> None:
    rng, page = np.random.default_rng(6), np.full((192, 192), 230, np.uint8)
    for y in range(4, 188, 6):
        for x in range(8, 180, 9):  # a stroke with soft edges
            page[y - 1 : y + 3, x : x + 6] = rng.integers(219, 230, (4, 6))
            page[y : y + 2, x + 1 : x + 5] = 218
    pixels = np.concatenate([crop("kodim23", np.s_[:192, :192]).pixels, np.repeat(page[..., None], 3, axis=2)], axis=1)
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(effort=1)).data
    with open_stream(data) as stream:
        found = stream.picture().pixels[:, 192:, 0].astype(float)
    ink, ground = found[page == 218].mean(), found[page == 230].mean()
    assert ground - ink > 0.9 * 12
