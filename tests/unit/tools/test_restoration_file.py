"""Networks of restoration in torch and in files, compared with what the package computes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec import _native
from sgicodec.model.gaussians import colour_matrix

torch = pytest.importorskip("torch")
from tools.restoration_file import RestorationNet, file_of, mean_of, network_of  # noqa: E402

PARTS = Path(__file__).parents[3] / "sgicodec" / "bitstream" / "parts"
SHIPPED = sorted(int(path.stem.removeprefix("restoration")) for path in PARTS.glob("restoration*.bin"))
STEP = 320


def shipped(number: int) -> bytes:
    return _native.shipped("restoration", number)


def random_network(channels: int, layers: int) -> RestorationNet:
    torch.manual_seed(5)
    network = RestorationNet(channels, layers)
    with torch.no_grad():
        for values in network.convolutions()[-1].parameters():
            values.normal_(std=0.02)
    return network


@pytest.mark.parametrize("number", SHIPPED)
def test_a_shipped_network_has_its_file(number: int) -> None:
    assert file_of(network_of(shipped(number))) == shipped(number)


@pytest.mark.parametrize("number", SHIPPED)
def test_the_package_computes_the_same_integers(number: int) -> None:
    network = network_of(shipped(number)).double()
    network.rounds = True
    seen = np.random.default_rng(number).integers(-900, 900, (3, 21, 37))
    unit, mix = 2.0 ** ((STEP - 480) / 32), np.array(colour_matrix(3))
    drawn = np.tensordot(mix.T, seen * (unit / 32), 1).astype(np.float32)
    found = _native.restoration_correction(drawn, number, STEP, [], 1, "auto").astype(np.float64)
    sums = network.sums(torch.from_numpy(seen / 32)[None])[0].detach().numpy()
    assert np.abs(sums).max() > 1000
    assert np.array_equal(np.rint(np.tensordot(mix, found, 1) / unit * network.scales()[-1].total), sums)


@pytest.mark.parametrize(("channels", "layers"), [(4, 2), (12, 3), (16, 4)])
def test_what_is_written_is_read(channels: int, layers: int) -> None:
    network = random_network(channels, layers).double()
    file = file_of(network)
    assert not network.rounds
    network.rounds = True
    again = network_of(file).double()
    again.rounds = True
    assert file_of(again)[2:5] == bytes([3, channels, file[4]])
    seen = 8 * torch.randn(1, 3, 20, 20, dtype=torch.float64)
    expected = network.sums(seen)
    assert expected.abs().max() > 100
    assert torch.equal(expected, expected.round())
    assert torch.equal(again.sums(seen), expected)


def test_rounding_changes_little_and_keeps_gradients() -> None:
    network = random_network(16, 4).double()
    seen = 2 * torch.randn(1, 3, 24, 24, dtype=torch.float64)
    plain = network(seen)
    network.rounds = True
    rounded = network(seen)
    assert 0 < (rounded - plain).abs().max() < 0.1 * plain.abs().max()
    rounded.square().sum().backward()
    assert all(values.grad is not None and values.grad.abs().sum() > 0 for values in network.parameters())


def test_the_first_layer_sees_no_brightness() -> None:
    network = random_network(16, 4)
    network.rounds = True
    weights = network.parts()[0][0]
    assert weights.abs().max() == 127
    assert (weights.sum(dim=(2, 3)) == 0).all()


def test_it_begins_without_a_correction() -> None:
    network = RestorationNet()
    assert not network(torch.randn(1, 3, 8, 8)).any()
    assert network_of(file_of(network)).scales()[-1].total <= 2.0**30


def test_a_file_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="bytes"):
        network_of(shipped(SHIPPED[0]) + b"\0")


def test_a_mean_lies_between_two_networks() -> None:
    one, other = random_network(4, 3), random_network(4, 3)
    with torch.no_grad():
        for values in other.parameters():
            values += 2.0
    for share in (0.0, 0.25, 1.0):
        for own, first in zip(mean_of(one, other, share).parameters(), one.parameters(), strict=True):
            torch.testing.assert_close(own, first + 2.0 * share)
