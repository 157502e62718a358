"""The search as a whole: streams show what it promised."""

import numpy as np
from data_files import crop

from sgicodec import EncodeSettings, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.picture import to_unit


def test_streams_cost_less() -> None:
    """Of a fitted photograph, from what is on disk and what is decoded: J falls by more than two in a hundred."""
    picture = crop("kodim23", np.s_[128:256, 100:292])
    unit, lmbda = to_unit(picture), 0.004
    costs = []
    for has_rdoq in (False, True):
        data = encode_picture(
            picture, EncodeSettings(lmbda=lmbda, steps=150, rdoq=has_rdoq, tune="psnr", texture=False)
        ).data
        error = np.sum((open_stream(data).render().astype(np.float64) - unit) ** 2)
        costs.append(error + lmbda * 8 * len(data))
    assert costs[1] < 0.98 * costs[0]
