"""What texture is quantised for: least squared error, or the eye."""

from __future__ import annotations

from dataclasses import dataclass

from sgicodec.model.texture_symbols import MOST_SLOPE, SAME_STEP, STEP_COUNT, STEP_ZERO, TextureSteps, step_index

__all__ = ["TUNINGS", "TextureTuning"]


@dataclass(frozen=True)
class TextureTuning:
    """How steps follow from λ.

    squared_steps: λ in squared steps, where steps do not grow. network: number of the shipped one that restores what is
    drawn for the same end. finer: 32nds of an octave by which the lowest frequency has a smaller step than λ says.
    growth: slopes of the first channel and of the others (see `TextureSteps`) where the lowest step is a grey level;
    they grow with its square root, as far as a stream can say. colours: steps of colour differences grow with this
    power of the first channel's. masking: steps grow with this power of the local standard deviation of luma, 0 for
    not at all ([texture_contrast.py](texture_contrast.py)). larger: how much larger streams are than the R-D model
    says, in octaves of λ.
    """

    squared_steps: float
    network: int
    finer: int = 0
    growth: tuple[float, float] = (0.0, 0.0)
    colours: float = 1.0
    masking: float = 0.0
    larger: float = 0.0

    def step(self, lmbda: float) -> int:
        """Index of the step for λ."""
        return max(0, step_index(float((lmbda / _SQUARED_STEPS) ** 0.5)) - self.finer)

    def price(self, lmbda: float) -> float:
        """λ in squared steps of `step(lmbda)`: what rounding takes from the step, it gives to the price of bits."""
        nominal = 2.0 ** ((self.step(lmbda) + self.finer - STEP_ZERO) / 32)
        return float(self.squared_steps * lmbda / (_SQUARED_STEPS * nominal**2))

    def steps(self, step: int, channels: int) -> TextureSteps:
        """Steps of all channels, of which the lowest is of this index."""
        step = min(max(step, 0), STEP_COUNT - 1)
        colour = SAME_STEP + round((1.0 - self.colours) * (_EQUAL_STEPS - step) / 4)
        ratios = (colour,) * 2 + (SAME_STEP,) * (channels - 3) if channels >= 3 else (SAME_STEP,) * (channels - 1)
        root = min((255.0 * TextureSteps(step).of_channels.item()) ** 0.5, _MAX_ROOT)
        luma, chroma = (min(round(2 * growth * root), MOST_SLOPE) for growth in self.growth)
        return TextureSteps(step, ratios, (luma, chroma), has_contrast=self.masking > 0)


_SQUARED_STEPS = 0.085
"""λ in squared steps; measured on eight pictures."""
_MAX_ROOT = 7.6
"""Square root of a step, grey levels, above which slopes stay: by eye, steeper ones soften."""
_EQUAL_STEPS = 428
"""Index of the step at which colour differences have the same, whatever power they follow: 83 grey levels."""

TUNINGS = {
    "psnr": TextureTuning(_SQUARED_STEPS, network=1),
    "visual": TextureTuning(0.0927, 3, 39, growth=(1.0, 4.0), colours=7 / 8, masking=0.4, larger=1.3),
}
