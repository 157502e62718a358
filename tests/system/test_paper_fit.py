"""What a short fit of the paper profile reaches, and that its stream keeps what the fit had."""

import numpy as np
from data_files import crop

from sgicodec import EncodeSettings, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.progress import NullListener
from sgicodec.fit.trainer import Progress
from sgicodec.metrics.psnr import psnr


class Watch(NullListener):
    """Keeps every step's PSNR, under the noise of that step, and bits."""

    def __init__(self) -> None:
        self.psnr: list[float] = []
        self.bits: list[float] = []

    def step(self, progress: Progress) -> bool:
        self.psnr.append(progress.psnr)
        self.bits.append(progress.bits)
        return True


def fitted(**settings: object) -> tuple[float, int, Watch]:
    """PSNR of what is decoded, bytes, and the steps of a fit of 2,400 Gaussians, one for 10 pixels."""
    picture, watch = crop("kodim23", np.s_[160:288, 80:272]), Watch()
    asked = EncodeSettings(profile="paper", steps=300, seeds=240, **settings)  # type: ignore[arg-type]
    data = encode_picture(picture, asked, progress=watch).data
    return psnr(picture.pixels, open_stream(data).picture().pixels), len(data), watch


def test_a_short_fit() -> None:
    """Where features cannot leave the noise, every seed shows one colour, at 14 dB; what the stream holds is what the
    fit saw; and MLP_p is asked at full size, under noise, alone.
    """
    decoded, size, watch = fitted()
    assert decoded > 23.0
    assert size < 18_000
    assert abs(decoded - float(np.mean(watch.psnr[-10:]))) < 0.3
    assert not any(watch.bits[:222])
    assert min(watch.bits[222:]) > 0
