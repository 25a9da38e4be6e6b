"""An arm of two links that reaches for a point."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import number
from kinetarium.envs.task import Array, Seen, Task


class Reacher(Task):
    """As Gymnasium's Reacher-v5: paid for holding the fingertip at the target, and for little torque."""

    file, frame_skip = "reacher.xml", 2

    def __init__(
        self,
        worlds: int = 1,
        *,
        reward_dist_weight: float = 1.0,
        reward_control_weight: float = 1.0,
        **options: Any,
    ) -> None:
        self._reward_dist_weight = number("reward_dist_weight", reward_dist_weight)
        self._reward_control_weight = number("reward_control_weight", reward_control_weight)
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array]:
        angles = seen.position[:, :2]
        return [
            np.cos(angles),
            np.sin(angles),
            seen.position[:, 2:],
            seen.velocity[:, :2],
            self.to_finger(seen)[:, :2],
        ]

    def to_finger(self, seen: Seen) -> Array:
        """From the target to the fingertip [m], shape (worlds, 3)."""
        finger, target = self.model.body("fingertip"), self.model.body("target")
        return seen.body_position[:, finger] - seen.body_position[:, target]

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        terms = {
            "reward_dist": -np.linalg.norm(self.to_finger(seen), axis=1) * self._reward_dist_weight,
            "reward_ctrl": -np.square(action).sum(axis=1) * self._reward_control_weight,
        }
        return sum(terms.values(), np.zeros(self.worlds)), np.zeros(self.worlds, bool), terms

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        position = random.uniform(low=-0.1, high=0.1, size=4) + self.init_position
        while True:
            goal = random.uniform(low=-0.2, high=0.2, size=2)
            if np.linalg.norm(goal) < 0.2:
                break
        position[-2:] = goal
        velocity = random.uniform(low=-0.005, high=0.005, size=4)
        velocity[-2:] = 0
        return position, velocity
