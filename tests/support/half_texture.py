"""A picture that is texture on one side and lines on the other."""

import numpy as np


def half_texture(height: int = 128, width: int = 256) -> np.ndarray:
    """Noise as in cloth on the left, soft lines on a smooth ground on the right."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[:height, :width]
    lines = np.full((height, width), 90.0)
    for _ in range(25):
        right, down = x - rng.uniform(0.55 * width, width), y - rng.uniform(0, height)
        length, angle = rng.uniform(6, 18), rng.uniform(0, np.pi)
        along, across = (right * np.cos(angle) + down * np.sin(angle), down * np.cos(angle) - right * np.sin(angle))
        lines += 100 * np.exp(-0.5 * (along / length) ** 2 - 0.25 * across**2)
    plane = np.where(x < width / 2, rng.normal(110, 40, (height, width)), lines)
    return np.repeat(np.clip(plane, 0, 255).astype(np.uint8)[..., None], 3, axis=2)
