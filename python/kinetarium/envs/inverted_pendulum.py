"""A pole on a cart."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import number
from kinetarium.envs.task import Array, Seen, Task


class InvertedPendulum(Task):
    """As Gymnasium's InvertedPendulum-v5: a reward for each step in which the pole leans by less than 0.2
    rad."""

    file, frame_skip = "inverted_pendulum.xml", 2

    def __init__(self, worlds: int = 1, *, reset_noise_scale: float = 0.01, **options: Any) -> None:
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array]:
        return [seen.position, seen.velocity]

    def healthy(self, seen: Seen) -> Array:
        """Whether the pole leans by 0.2 rad at most, shape (worlds,)."""
        return np.abs(seen.position[:, 1]) <= 0.2

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        healthy = self.healthy(seen)
        reward = healthy.astype(np.float64)
        return reward, ~healthy, {"reward_survive": reward}

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale)
