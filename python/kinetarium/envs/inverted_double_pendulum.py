"""Two poles, one on the other, on a cart."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import number
from kinetarium.envs.task import Array, Seen, Task

# Of the site "tip" on the second pole [m].
_TIP = 0.6


class InvertedDoublePendulum(Task):
    """As Gymnasium's InvertedDoublePendulum-v5: paid for holding the tip high and still."""

    file, frame_skip = "inverted_double_pendulum.xml", 5

    def __init__(
        self,
        worlds: int = 1,
        *,
        healthy_reward: float = 10.0,
        reset_noise_scale: float = 0.1,
        **options: Any,
    ) -> None:
        self._healthy_reward = number("healthy_reward", healthy_reward)
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array]:
        angles = seen.position[:, 1:]
        return [
            seen.position[:, :1],
            np.sin(angles),
            np.cos(angles),
            np.clip(seen.velocity, -10, 10),
            np.clip(self.limit_force(seen), -10, 10),
        ]

    def limit_force(self, seen: Seen) -> Array:
        """`qfrc_constraint` of the cart [N]: what of the slider's force is neither the motor's nor the
        damper's."""
        damping: Array = self.model.parameter("damping")[0, 0] * seen.velocity[:, 0]
        return seen.joint_force[:, 0, 0] - seen.motor_force[:, 0] + damping

    def tip(self, seen: Seen) -> tuple[Array, Array]:
        """How far along the rail the tip is, and how high [m], shape (worlds,) each."""
        pole = seen.body_position[:, self.model.body("pole2")]
        lean = seen.position[:, 1] + seen.position[:, 2]
        return pole[:, 0] + _TIP * np.sin(lean), pole[:, 2] + _TIP * np.cos(lean)

    def healthy(self, seen: Seen) -> Array:
        """Whether the tip is above 1 m, shape (worlds,)."""
        return self.tip(seen)[1] > 1

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        (x, y), healthy = self.tip(seen), self.healthy(seen)
        terms = {
            "reward_survive": healthy * self._healthy_reward,
            "distance_penalty": -(0.01 * x**2 + (y - 2) ** 2),
            "velocity_penalty": -(1e-3 * seen.velocity[:, 1] ** 2 + 5e-3 * seen.velocity[:, 2] ** 2),
        }
        return sum(terms.values(), np.zeros(self.worlds)), ~healthy, terms

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale, normal_velocity=True)
