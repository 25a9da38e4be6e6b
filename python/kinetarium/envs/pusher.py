"""An arm that pushes a cylinder to a goal."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import number
from kinetarium.envs.task import Array, Seen, Task


class Pusher(Task):
    """As Gymnasium's Pusher-v5: paid for the cylinder near the goal, the arm near the cylinder, and little
    torque."""

    file, frame_skip = "pusher_v5.xml", 5

    def __init__(
        self,
        worlds: int = 1,
        *,
        reward_near_weight: float = 0.5,
        reward_dist_weight: float = 1.0,
        reward_control_weight: float = 0.1,
        **options: Any,
    ) -> None:
        self._reward_near_weight = number("reward_near_weight", reward_near_weight)
        self._reward_dist_weight = number("reward_dist_weight", reward_dist_weight)
        self._reward_control_weight = number("reward_control_weight", reward_control_weight)
        super().__init__(worlds, **options)

    def body(self, seen: Seen, name: str) -> Array:
        """Positions of a body [m], shape (worlds, 3)."""
        return seen.body_position[:, self.model.body(name)]

    def observation(self, seen: Seen) -> list[Array]:
        bodies = [self.body(seen, name) for name in ("tips_arm", "object", "goal")]
        return [seen.position[:, :7], seen.velocity[:, :7], *bodies]

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        thing = self.body(seen, "object")
        to_arm, to_goal = thing - self.body(seen, "tips_arm"), thing - self.body(seen, "goal")
        terms = {
            "reward_dist": -np.linalg.norm(to_goal, axis=1) * self._reward_dist_weight,
            "reward_ctrl": -np.square(action).sum(axis=1) * self._reward_control_weight,
            "reward_near": -np.linalg.norm(to_arm, axis=1) * self._reward_near_weight,
        }
        return sum(terms.values(), np.zeros(self.worlds)), np.zeros(self.worlds, bool), terms

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        while True:
            cylinder = np.concatenate(
                [random.uniform(low=-0.3, high=0, size=1), random.uniform(low=-0.2, high=0.2, size=1)]
            )
            if np.linalg.norm(cylinder) > 0.17:
                break
        position = self.init_position.copy()
        position[-4:-2] = cylinder
        position[-2:] = 0
        velocity = random.uniform(low=-0.005, high=0.005, size=11)
        velocity[-4:] = 0
        return position, velocity
