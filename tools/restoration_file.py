"""Networks of restoration as torch trains them, and their files of integers (docs/format.md, "Restoration")."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

INPUT_UNIT = 128.0
"""Of an input of one step."""
HIDDEN_UNIT = 128.0
"""About that of hidden values, of one step."""
BIAS_UNIT = 64.0
"""In sums, of a bias of 1."""
MAX_WEIGHT, MAX_VALUE = 127, 32767
MIN_SCALED = 1e-3
"""A largest weight of a layer below this is scaled as if it were this."""
TAPS = 9


@dataclass(frozen=True)
class Scales:
    """Units of a layer. weight: of a weight of 1; total: of sums of 1; shift: bits that sums lose, none in the last
    layer.
    """

    weight: float
    total: float
    shift: int


class RestorationNet(nn.Module):
    """From what was drawn [N, 3, H, W], in steps, to its correction. It begins with none.

    rounds: whether it computes as its file says, in integers, which gradients do not see. Sums are exact in double
    precision, and nearly so in single.
    """

    def __init__(self, channels: int = 16, layers: int = 4) -> None:
        super().__init__()
        widths = [3] + [channels] * (layers - 1) + [3]
        self.layers = nn.ModuleList(nn.Conv2d(inputs, outputs, 3) for inputs, outputs in pairwise(widths))
        self.rounds = False
        for values in self.convolutions()[-1].parameters():
            nn.init.zeros_(values)

    def convolutions(self) -> list[nn.Conv2d]:
        """The layers."""
        return [layer for layer in self.layers if isinstance(layer, nn.Conv2d)]

    def weights(self) -> list[Tensor]:
        """Of each layer [outputs, inputs, 3, 3]. Those of the first add up to 0: it does not see how bright it is."""
        first, *others = (layer.weight for layer in self.convolutions())
        return [first - first.mean(dim=(2, 3), keepdim=True), *others]

    def scales(self) -> list[Scales]:
        """Units in which weights have 8 bits, and what the last layer gives is that of a power of two."""
        found: list[Scales] = []
        unit = INPUT_UNIT
        most = [max(float(weights.detach().abs().max()), MIN_SCALED) for weights in self.weights()]
        for value in most[:-1]:
            total = unit * MAX_WEIGHT / value
            shift = max(0, round(math.log2(total / HIDDEN_UNIT)))
            found.append(Scales(MAX_WEIGHT / value, total, shift))
            unit = total / 2**shift
        total = 2.0 ** math.floor(math.log2(unit * MAX_WEIGHT / most[-1]) + 1e-6)
        return [*found, Scales(total / unit, total, 0)]

    def parts(self) -> list[tuple[Tensor, Tensor]]:
        """Weights and biases of each layer in their units; integers where it rounds."""
        found = []
        for number, (layer, weights, scales) in enumerate(
            zip(self.convolutions(), self.weights(), self.scales(), strict=True)
        ):
            if layer.bias is None:
                raise ValueError("a layer without biases")
            weights, biases = weights * scales.weight, layer.bias * (scales.total / BIAS_UNIT)
            if self.rounds:
                weights = _as_if(weights, _integers(weights.detach(), balanced=number == 0))
                biases = _as_if(biases, biases.detach().round().clamp(-MAX_VALUE, MAX_VALUE))
            found.append((weights, biases))
        return found

    def sums(self, drawn: Tensor) -> Tensor:
        """What the last layer adds up to."""
        values = drawn * INPUT_UNIT
        if self.rounds:
            values = _as_if(values, values.detach().round().clamp(-MAX_VALUE, MAX_VALUE))
        values = F.pad(values, (len(self.layers),) * 4, mode="replicate")
        (*hidden, (weights, biases)), scales = self.parts(), self.scales()
        for (own, bias), scale in zip(hidden, scales[:-1], strict=True):
            values = F.relu(F.conv2d(values, own, BIAS_UNIT * bias) * 2.0**-scale.shift)
            if self.rounds:
                values = _as_if(values, values.detach().floor().clamp(max=MAX_VALUE))
        return F.conv2d(values, weights, BIAS_UNIT * biases)

    def forward(self, drawn: Tensor) -> Tensor:
        """See the class."""
        return self.sums(drawn) / self.scales()[-1].total


def file_of(network: RestorationNet) -> bytes:
    """The file of a network."""
    scales, rounded = network.scales(), network.rounds
    network.rounds = True
    with torch.no_grad():
        parts = [(weights.numpy(), biases.numpy()) for weights, biases in network.parts()]
    network.rounds = rounded
    data = bytes([len(parts), round(math.log2(scales[-1].total))])
    for (weights, _), scale in zip(parts, scales, strict=True):
        data += bytes([weights.shape[1], weights.shape[0], scale.shift])
    return data + b"".join(w.astype(np.int8).tobytes() + b.astype("<i2").tobytes() for w, b in parts)


def network_of(file: bytes) -> RestorationNet:
    """The network of a file, which its own file equals. Raises ValueError for one of layers of different widths."""
    count, power = file[:2]
    heads = [tuple(file[at : at + 3]) for at in range(2, 2 + 3 * count, 3)]
    network = RestorationNet(heads[0][1], count)
    at, unit = 2 + 3 * count, INPUT_UNIT
    for number, (layer, (inputs, outputs, shift)) in enumerate(zip(network.convolutions(), heads, strict=True)):
        if layer.bias is None or layer.weight.shape[:2] != (outputs, inputs):
            raise ValueError("layers of different widths")
        total = 2.0**power if number == count - 1 else HIDDEN_UNIT * 2.0**shift
        size = outputs * inputs * TAPS
        weights = np.frombuffer(file, np.int8, size, at).reshape(layer.weight.shape) * (unit / total)
        biases = np.frombuffer(file, "<i2", outputs, at + size) * (BIAS_UNIT / total)
        at, unit = at + size + 2 * outputs, HIDDEN_UNIT
        with torch.no_grad():
            layer.weight.copy_(torch.from_numpy(weights))
            layer.bias.copy_(torch.from_numpy(biases))
    if at != len(file):
        raise ValueError(f"a file of {len(file)} bytes, not {at}")
    return network


def _as_if(values: Tensor, others: Tensor) -> Tensor:
    """Other values with the gradients of these."""
    return others + (values - values.detach())


def _integers(weights: Tensor, balanced: bool) -> Tensor:
    """Weights [outputs, inputs, 3, 3] rounded to 8 bits. balanced: those from an input to an output add up to 0; where
    rounded ones do not, those that were nearest to the next integer take it.
    """
    rounded = weights.round().clamp(-MAX_WEIGHT, MAX_WEIGHT)
    if not balanced:
        return rounded
    taps, rest = rounded.flatten(2), (weights - rounded).flatten(2)
    excess = taps.sum(dim=2, keepdim=True)
    for sign in (1, -1):
        cost = torch.where(taps == -sign * MAX_WEIGHT, math.inf, sign * rest)
        rank = cost.argsort(dim=2).argsort(dim=2)
        taps = taps - sign * (rank < sign * excess).to(taps)
    return taps.view_as(weights)
