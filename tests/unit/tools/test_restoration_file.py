"""Networks of restoration in torch and in files, compared with what the package computes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec import _native

torch = pytest.importorskip("torch")
from tools.restoration_file import file_of, network_of  # noqa: E402

PARTS = Path(__file__).parents[3] / "sgicodec" / "bitstream" / "parts"
SHIPPED = sorted(int(path.stem.removeprefix("restoration")) for path in PARTS.glob("restoration*.bin"))
STEP = 320


def shipped(number: int) -> bytes:
    return (PARTS / f"restoration{number}.bin").read_bytes()


@pytest.mark.parametrize("number", SHIPPED)
def test_a_shipped_network_has_its_file(number: int) -> None:
    assert file_of(network_of(shipped(number))) == shipped(number)


@pytest.mark.parametrize("number", SHIPPED)
def test_the_package_computes_the_same_integers(number: int) -> None:
    network = network_of(shipped(number)).double()
    network.rounds = True
    seen = np.random.default_rng(number).integers(-900, 900, (3, 21, 37))
    unit = 2.0 ** ((STEP - 480) / 32)
    drawn = (seen * (unit / 32)).astype(np.float32)
    found = _native.restoration_correction(drawn, number, STEP, 1, "auto").astype(np.float64)
    sums = network.sums(torch.from_numpy(seen / 32)[None])[0].detach().numpy()
    assert np.abs(sums).max() > 1000
    assert np.array_equal(np.rint(found / unit * network.scales()[-1].total), sums)
