"""A running robot in a plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import flag, number
from kinetarium.envs.task import Array, Seen, Task


class HalfCheetah(Task):
    """As Gymnasium's HalfCheetah-v5: paid for speed, and for little torque. It never fails."""

    file, frame_skip, turning = "half_cheetah.xml", 5, ("rooty",)

    def __init__(
        self,
        worlds: int = 1,
        *,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 0.1,
        reset_noise_scale: float = 0.1,
        exclude_current_positions_from_observation: bool = True,
        **options: Any,
    ) -> None:
        self._forward_reward_weight = number("forward_reward_weight", forward_reward_weight)
        self._ctrl_cost_weight = number("ctrl_cost_weight", ctrl_cost_weight)
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        self._hidden = int(
            flag("exclude_current_positions_from_observation", exclude_current_positions_from_observation)
        )
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array]:
        return [seen.position[:, self._hidden :], seen.velocity]

    def place(self, seen: Seen) -> Array:
        return seen.position[:, :1]

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        return {"x_position": seen.position[:, 0]}

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        terms = {
            "reward_forward": self._forward_reward_weight * velocity[:, 0],
            "reward_ctrl": -self._ctrl_cost_weight * np.square(action).sum(axis=1),
        }
        reward = sum(terms.values(), np.zeros(self.worlds))
        return reward, np.zeros(self.worlds, bool), {"x_velocity": velocity[:, 0]} | terms

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale, normal_velocity=True)
