"""Noise of custom sensors: that of the engine's own, with the same random numbers to 1e-5."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from kinetarium.errors import SensorError

if TYPE_CHECKING:
    from kinetarium.sensors import Noise

_WORD, _LONG = 0xFFFFFFFF, 0xFFFFFFFFFFFFFFFF
# What a random number is for.
_WHITE, _WALK, _BIAS = range(3)


def check(sensor: str, noise: Noise, numbers: int | None = None) -> None:
    """`SensorError` for levels that cannot be, or, where it is known how many numbers a reading has, are not as
    many."""
    for level in fields(noise):
        what = f'sensor "{sensor}": the {level.name} of its noise'
        value = np.asarray(getattr(noise, level.name), np.float64)
        if not ((value >= 0) & (value <= 1e9)).all():
            raise SensorError(f"{what} is {value}: it must be from 0 to 1e9, in the reading's unit")
        if numbers is not None and value.shape not in ((), (numbers,)):
            raise SensorError(
                f"{what} has {value.size} numbers, but the sensor has {numbers}: give one for each, or one for all"
            )


def key_of(seed: int, name: str) -> int:
    """Of the seed and the sensor's name: FNV-1a over both, mixed as SplitMix64 does."""
    key = 0xCBF29CE484222325
    for byte in int(seed).to_bytes(8, "little") + name.encode():
        key = ((key ^ byte) * 0x100000001B3) & _LONG
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        key = ((key ^ (key >> shift)) * factor) & _LONG
    return key ^ (key >> 31)


def _philox(c: list[np.ndarray], k: list[np.ndarray]) -> list[np.ndarray]:
    """Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, §3.3) of counters and keys: words of 32 bits, in uint64."""
    for _ in range(10):
        a, b = c[0] * np.uint64(0xD2511F53), c[2] * np.uint64(0xCD9E8D57)
        c = [(b >> 32) ^ c[1] ^ k[0], b & _WORD, (a >> 32) ^ c[3] ^ k[1], a & _WORD]
        k = [(k[0] + 0x9E3779B9) & _WORD, (k[1] + 0xBB67AE85) & _WORD]
    return c


@dataclass(frozen=True)
class Draw:
    """Samples of a sensor, one in each of some worlds; arrays of the shape (worlds,)."""

    key: int
    world: np.ndarray
    began: np.ndarray
    """How often the world has begun anew."""
    sample: np.ndarray
    elapsed: np.ndarray
    """Time since the one before [s], 0 at the first."""

    def disturb(self, truth: np.ndarray, noise: Noise, walk: np.ndarray) -> np.ndarray:
        """What is read of numbers x, shape (worlds, numbers), with normal numbers z that are a function of all of the
        above but the time:

            w ← w + σ_walk √Δt z
            reading = step · round((x + σ_bias z' + w + σ z") / step)

        `walk` are the biases w that wander; they are changed.
        """
        n = truth.shape[1]
        if np.any(noise.walk):
            walk += np.multiply(noise.walk, np.sqrt(self.elapsed)[:, None] * self._normal(_WALK, n))
        reading = truth + walk
        if np.any(noise.bias):
            reading += np.multiply(noise.bias, self._normal(_BIAS, n))
        if np.any(noise.deviation):
            reading += np.multiply(noise.deviation, self._normal(_WHITE, n))
        step = np.broadcast_to(np.asarray(noise.step, np.float64), reading.shape)
        coarse = step > 0
        reading[coarse] = np.round(reading[coarse] / step[coarse]) * step[coarse]
        return reading

    def _normal(self, purpose: int, n: int) -> np.ndarray:
        """Normal numbers (Box & Muller 1958), shape (worlds, n)."""
        world, began, sample = (x.astype(np.uint64)[:, None] for x in (self.world, self.began, self.sample))
        if purpose == _BIAS:  # drawn once, for good
            began, sample = np.zeros_like(began), np.zeros_like(sample)
        blocks = np.arange(-(-n // 4), dtype=np.uint64)[None] | np.uint64(purpose << 30)
        key = [np.full_like(sample, self.key & _WORD), (sample >> 32) ^ np.uint64(self.key >> 32)]
        words = _philox(list(np.broadcast_arrays(sample & _WORD, began, world, blocks)), key)
        numbers = []
        for u, v in (words[:2], words[2:]):
            radius, angle = np.sqrt(-2 * np.log((u + 1.0) / 2**32)), v * (2 * np.pi / 2**32)
            numbers += [radius * np.cos(angle), radius * np.sin(angle)]
        return np.stack(numbers, axis=-1).reshape(len(world), -1)[:, :n]
